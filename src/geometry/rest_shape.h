#pragma once

#include <vector>

#include "geometry/triangle_mesh.h"
#include "linalg/isotropic_hessian.h"

namespace taut {

/// A triangle as energies and limits see it: its vertices (indices into the unknowns' nodes), its rest area (m^2), and
/// shape = A B of SL (20), so that F = sum_j x_j shape_j is the 3x2 deformation gradient from an orthonormal frame of
/// the rest triangle.
struct RestTriangle {
  Triangle vertices;
  TriangleShape shape;
  double area;

  /// F at the nine local coordinates x0, x1, x2.
  Matrix32 deformation_gradient(const double* x) const { return Eigen::Map<const Matrix3>(x) * shape; }
};

/// Rest triangles from 3D corner positions; the frame's first axis is along edge 0-1 (singular values do not depend on
/// it). `first_vertex` is added to the vertex indices.
std::vector<RestTriangle> rest_triangles(const std::vector<Triangle>& triangles,
                                         const std::vector<Vector3>& rest_positions, int first_vertex = 0);

/// Rest triangles from 2D corner positions (uv), one triple per triangle.
std::vector<RestTriangle> rest_triangles(const std::vector<Triangle>& triangles,
                                         const std::vector<std::array<Vector2, 3>>& corners, int first_vertex = 0);

}  // namespace taut
