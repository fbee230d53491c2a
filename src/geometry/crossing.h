#pragma once

#include <optional>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace taut {

/// Two triangles that cross.
struct Crossing {
  int first, second;
};

/// The first pair of triangles that go through each other, or nothing. Triangles that only touch, as neighbours do and
/// the two sides of a slit, do not: each is shrunk by a millionth of its size about its centroid before exact
/// predicates decide. Needs a build with CGAL; without it there is never a pair.
std::optional<Crossing> find_crossing(const std::vector<Vector3>& points, const std::vector<Triangle>& triangles);

}  // namespace taut
