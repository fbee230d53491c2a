#pragma once

#include <cmath>

#include "constraints/strain_limit.h"
#include "geometry/grid.h"
#include "geometry/rest_shape.h"

namespace taut {

/// All coordinates of a list of points, three a point.
inline Vector flatten(const std::vector<Vector3>& points) {
  Vector x(3 * static_cast<Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) x.segment<3>(3 * static_cast<Index>(i)) = points[i];
  return x;
}

/// map(point) for each point.
template <class Map>
std::vector<Vector3> mapped(std::vector<Vector3> points, const Map& map) {
  for (Vector3& point : points) point = map(point);
  return points;
}

/// A limit on all of these triangles.
inline StrainLimitTriangles limit_on(const std::vector<RestTriangle>& triangles, double min, double max) {
  StrainLimitTriangles limit;
  limit.constraint = "limit";
  limit.body = "cloth";
  limit.triangles = triangles;
  for (std::size_t i = 0; i < triangles.size(); ++i) limit.ids.push_back(static_cast<int>(i));
  limit.min = min;
  limit.max = max;
  return limit;
}

/// An octahedron about the origin with corners at distance 1, normals outwards.
inline TriangleMesh octahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

/// The point of a sheet rolled along x onto a cylinder of curvature `kappa`: lengths in the sheet do not change.
inline Vector3 rolled(const Vector3& point, double kappa) {
  return {std::sin(kappa * point.x()) / kappa, point.y(), (1 - std::cos(kappa * point.x())) / kappa};
}

}  // namespace taut
