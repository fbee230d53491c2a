// CGAL's AABB tree is GPL-3+ (docs/licences.md); without CGAL, prolongation.cpp looks at every triangle.
#ifdef TAUT_WITH_CGAL

#define CGAL_NDEBUG

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include "geometry/prolongation.h"

namespace taut {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 point_of(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

std::vector<int> nearest_triangles(const TriangleMesh& mesh, const std::vector<Vector3>& points) {
  Triangles triangles;
  for (const Triangle& t : mesh.triangles)
    triangles.emplace_back(point_of(mesh.vertices[t[0]]), point_of(mesh.vertices[t[1]]), point_of(mesh.vertices[t[2]]));
  Tree tree(triangles.cbegin(), triangles.cend());
  tree.accelerate_distance_queries();
  std::vector<int> nearest;
  for (const Vector3& point : points) {
    const auto [at, primitive] = tree.closest_point_and_primitive(point_of(point));
    nearest.push_back(static_cast<int>(primitive - triangles.cbegin()));
  }
  return nearest;
}

}  // namespace taut

#endif
