#pragma once

#include <vector>

#include "core/energy.h"

namespace taut {

/// Rayleigh damping in proportion to the stiffness: W(x) = c/2 (x - o)^T K(x_n) (x - o), with K the positive
/// semidefinite Hessian of another energy at the last positions x_n, and c (x - o) = beta v the velocity at the end of
/// the step (implicit Euler: o = x_n, c = beta/h; beta in s). A convex quadratic within the step.
class StiffnessDamping final : public Energy {
 public:
  /// `energy` is borrowed.
  StiffnessDamping(std::string name, const Energy& energy);

  /// Takes K from `positions` at the start of the step, and o from `origin`.
  void set_reference(double coefficient, const Vector& positions, const Vector& origin);
  /// The same with o = x_n.
  void set_reference(double coefficient, const Vector& positions) { set_reference(coefficient, positions, positions); }

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return energy_.stencils(); }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;
  bool couples_weakly() const override { return energy_.couples_weakly(); }

 private:
  std::string name_;
  const Energy& energy_;
  double coefficient_ = 0;
  Vector origin_;
  std::vector<double> stiffness_;  // width x width per element
};

}  // namespace taut
