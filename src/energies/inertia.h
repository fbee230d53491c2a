#pragma once

#include <span>
#include <vector>

#include "core/energy.h"
#include "geometry/rest_shape.h"

namespace taut {

/// W(x) = a/2 (x - t)^T M (x - t): inertia with a = 1/h^2 about the predicted position t, or mass-proportional damping
/// about the last one. M is lumped (one node an element) or consistent (one triangle or prism an element); both
/// coefficient and target change from step to step.
class Inertia final : public Energy {
 public:
  /// A third of each triangle's mass on each of its vertices; `surface_density` in kg/m^2, `vertices` the number of
  /// vertices of the whole scene.
  static Inertia lumped(std::string name, const std::vector<RestTriangle>& triangles, double surface_density,
                        Index vertices);
  /// Linear triangles integrated exactly: surface_density * area / 12 * [2 1 1; 1 2 1; 1 1 2].
  static Inertia consistent(std::string name, const std::vector<RestTriangle>& triangles, double surface_density);

  /// No elements yet, of `nodes` nodes each (at most 8) with `axes` variables a node: 3 coordinates, or 1 of a mode.
  Inertia(std::string name, int nodes, int axes = 3)
      : name_(std::move(name)), nodes_(nodes), axes_(axes), stencils_(axes * nodes) {}
  /// Appends an element on these nodes; `mass` is its symmetric nodes x nodes mass matrix, kg, for each coordinate.
  void add_element(std::span<const int> nodes, std::span<const double> mass);

  /// `coefficient` a in 1/s^2 and `target` t, one entry per variable of the scene, m.
  void set_target(double coefficient, const Vector& target);

  /// Adds M v to `out` (both one entry per variable).
  void add_product(const Vector& v, Vector& out) const;
  double kinetic_energy(const Vector& velocity) const;

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;
  bool takes_four(Curvature /*curvature*/) const override { return true; }
  Pack evaluate_four(Index quad, const Pack* x, Pack* gradient, Pack* hessian, Curvature curvature) const override;

 private:
  template <class Real>
  Real evaluate_block(Index block, const Real* x, Real* gradient, Real* hessian) const;
  /// Entry (i, j) of the element's node mass matrix, kg.
  double mass(Index element, int i, int j) const { return mass_[(element * nodes_ + i) * nodes_ + j]; }

  std::string name_;
  int nodes_, axes_;
  Stencils stencils_;
  std::vector<double> mass_;  // kg, nodes x nodes an element
  double coefficient_ = 0;
  Vector target_;
};

}  // namespace taut
