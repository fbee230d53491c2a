#pragma once

#include "core/energy.h"

namespace taut {

/// W(x) = -f . x with nodal forces that do not depend on x: gravity, point and edge loads, and loads without a
/// potential (wind) that are evaluated at the start of the step and held during it (lagged).
class DeadLoad final : public Energy {
 public:
  /// `forces`: one entry per variable of the scene, N; vertices whose force is zero and stays zero are left out.
  /// With `keep_all` every vertex in `forces` gets a stencil, so that the forces may change later.
  DeadLoad(std::string name, Vector forces, bool keep_all = false);

  /// Replaces the forces (same size).
  void set_forces(const Vector& forces);
  /// As given, without the factor, N.
  const Vector& forces() const { return forces_; }
  /// Multiplies the forces; static load steps go from 0 to 1.
  void set_factor(double factor) { factor_ = factor; }

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  bool has_curvature() const override { return false; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;

 private:
  std::string name_;
  Stencils stencils_{3};
  Vector forces_;
  double factor_ = 1;
};

}  // namespace taut
