// Intersections of triangles by CGAL's kernel (LGPL) and its box intersection (GPL-3+; docs/licences.md).
#ifdef TAUT_WITH_CGAL

#define CGAL_NDEBUG

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/box_intersection_d.h>

#include "geometry/crossing.h"

namespace taut {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

constexpr double shrinkage = 1e-6;

Kernel::Triangle_3 shrunk(const std::vector<Vector3>& points, const Triangle& triangle) {
  const Vector3 centroid = (points[triangle[0]] + points[triangle[1]] + points[triangle[2]]) / 3;
  Kernel::Point_3 corners[3];
  for (int j = 0; j < 3; ++j) {
    const Vector3 corner = points[triangle[j]] + shrinkage * (centroid - points[triangle[j]]);
    corners[j] = {corner.x(), corner.y(), corner.z()};
  }
  return {corners[0], corners[1], corners[2]};
}

/// A box that knows its triangle.
struct TriangleBox : CGAL::Box_intersection_d::Box_d<double, 3> {
  int triangle;
  TriangleBox(const CGAL::Bbox_3& box, int index) : Box_d(box), triangle(index) {}
};

}  // namespace

std::optional<Crossing> find_crossing(const std::vector<Vector3>& points, const std::vector<Triangle>& triangles) {
  std::vector<Kernel::Triangle_3> shapes;
  std::vector<TriangleBox> boxes;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    shapes.push_back(shrunk(points, triangles[t]));
    boxes.emplace_back(shapes.back().bbox(), static_cast<int>(t));
  }
  std::optional<Crossing> first;
  CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const TriangleBox& a, const TriangleBox& b) {
    const int low = std::min(a.triangle, b.triangle), high = std::max(a.triangle, b.triangle);
    if (first && std::pair(first->first, first->second) <= std::pair(low, high)) return;
    if (CGAL::do_intersect(shapes[low], shapes[high])) first = Crossing{low, high};
  });
  return first;
}

}  // namespace taut

#endif  // TAUT_WITH_CGAL
