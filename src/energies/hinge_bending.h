#pragma once

#include <vector>

#include "core/energy.h"
#include "geometry/triangle_mesh.h"

namespace taut {

/// An inner edge of a mesh with its two triangles: edge from x0 to x1, x2 opposite in the triangle (x0, x1, x2), x3
/// opposite in (x1, x0, x3).
struct Hinge {
  std::array<int, 4> vertices;
  double stiffness;   ///< k in k/2 (theta - rest)^2, N m
  double rest_angle;  ///< rad
};

/// The signed angle between the normals of the two triangles of a hinge, 0 when flat, in (-pi, pi]; x holds x0, x1, x2,
/// x3.
double hinge_angle(const double* x);

/// Hinges of all inner edges with k = 3 D |e|^2/(A1 + A2) from the rest shape [Grinspun et al. 2003; Wardetzky et al.
/// 2007], D the bending stiffness in N m. The rest angles are those of `rest_positions`; with `flat_rest` they are 0.
std::vector<Hinge> make_hinges(const std::vector<Triangle>& triangles, const std::vector<Vector3>& rest_positions,
                               double bending_stiffness, bool flat_rest, int first_vertex = 0);

/// The same from corner positions in the plane (uv), one triple per triangle, with rest angles 0. An edge along a seam
/// has a length in either triangle; the mean of their squares counts.
std::vector<Hinge> make_hinges(const std::vector<Triangle>& triangles,
                               const std::vector<std::array<Vector2, 3>>& corners, double bending_stiffness,
                               int first_vertex = 0);

/// Discrete-hinge bending: sum over inner edges of k/2 (theta - rest)^2. The positive semidefinite form is the
/// Gauss-Newton part k theta' theta'^T; the exact one adds k (theta - rest) theta'' [Tamstorf and Grinspun 2013].
class HingeBending final : public Energy {
 public:
  HingeBending(std::string name, std::vector<Hinge> hinges);

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;
  bool takes_four(Curvature curvature) const override { return curvature == Curvature::positive_semidefinite; }
  Pack evaluate_four(Index quad, const Pack* x, Pack* gradient, Pack* hessian, Curvature curvature) const override;
  bool couples_weakly() const override { return true; }
  const std::vector<Hinge>& hinges() const { return hinges_; }

 private:
  std::string name_;
  std::vector<Hinge> hinges_;
  struct Quad {
    Pack stiffness, rest_angle;
  };
  std::vector<Quad> quads_;
  Stencils stencils_{12};
};

}  // namespace taut
