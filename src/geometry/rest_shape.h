#pragma once

#include <array>
#include <vector>

#include "core/pack.h"
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

  std::array<std::array<double, 2>, 3> shape_rows() const {
    return {{{shape(0, 0), shape(0, 1)}, {shape(1, 0), shape(1, 1)}, {shape(2, 0), shape(2, 1)}}};
  }
  /// F at the nine local coordinates x0, x1, x2.
  Matrix32 deformation_gradient(const double* x) const { return Eigen::Map<const Matrix3>(x) * shape; }
};

/// The rest shapes and areas of the triangles in each quad (core/pack.h).
struct RestQuad {
  std::array<std::array<Pack, 2>, 3> shape;
  Pack area;
};
std::vector<RestQuad> rest_quads(const std::vector<RestTriangle>& triangles);

/// The columns of F = sum_j x_j shape_j of one triangle (Real = double) or four (Pack).
template <class Real>
struct DeformationGradient {
  std::array<Real, 3> f1, f2;

  template <class Shape>
  DeformationGradient(const Real* x, const Shape& shape) {
    for (int axis = 0; axis < 3; ++axis) {
      f1[axis] = x[axis] * shape[0][0] + x[3 + axis] * shape[1][0] + x[6 + axis] * shape[2][0];
      f2[axis] = x[axis] * shape[0][1] + x[3 + axis] * shape[1][1] + x[6 + axis] * shape[2][1];
    }
  }
  Real c11() const { return f1[0] * f1[0] + f1[1] * f1[1] + f1[2] * f1[2]; }
  Real c12() const { return f1[0] * f2[0] + f1[1] * f2[1] + f1[2] * f2[2]; }
  Real c22() const { return f2[0] * f2[0] + f2[1] * f2[1] + f2[2] * f2[2]; }
};

/// Rest triangles from 3D corner positions; the frame's first axis is along edge 0-1 (singular values do not depend on
/// it). `first_vertex` is added to the vertex indices.
std::vector<RestTriangle> rest_triangles(const std::vector<Triangle>& triangles,
                                         const std::vector<Vector3>& rest_positions, int first_vertex = 0);

/// Rest triangles from 2D corner positions (uv), one triple per triangle.
std::vector<RestTriangle> rest_triangles(const std::vector<Triangle>& triangles,
                                         const std::vector<std::array<Vector2, 3>>& corners, int first_vertex = 0);

}  // namespace taut
