#pragma once

#include <string>

#include "core/energy.h"
#include "dynamics/modal/modal_basis.h"

namespace taut {

/// W(q) = 1/2 sum_k stiffness_k q_k^2, a mode an element.
class ModalStiffness final : public Energy {
 public:
  /// `stiffness` has one entry per mode: for the elastic energy the eigenvalues, 1/s^2.
  ModalStiffness(std::string name, Vector stiffness);

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* q, double* gradient, double* hessian,
                  Curvature curvature) const override;

 private:
  std::string name_;
  Stencils stencils_{1};
  Vector stiffness_;
};

/// Dead forces on the warped nodes, W(q) = -sum_i f_i . R~(w_i) d_i: one element with all modes. Its gradient is -J^T f
/// with the exact Jacobian; Phi^T R^T f of MW (A.6) is no gradient. With frozen rotations W is linear,
/// -sum_i f_i . R~(w~_i) Phi_i q.
class WarpedLoad final : public Energy {
 public:
  /// `forces`: 3 entries a node, N.
  WarpedLoad(std::string name, const ModalBasis& basis, const Vector& forces);

  void set_factor(double factor) { factor_ = factor; }
  /// Holds the rotations of all nodes at those of q (named option: MW takes them from the predictor).
  void freeze(const Vector& q);

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* q, double* gradient, double* hessian,
                  Curvature curvature) const override;

 private:
  std::string name_;
  Stencils stencils_;
  Matrix shapes_, rotations_;  // of the loaded nodes, transposed: modes x 3 nodes
  Vector forces_;              // on them, N
  double factor_ = 1;
  Vector frozen_force_;  // sum_i Phi_i^T R~(w~_i)^T f_i; empty unless frozen
};

/// Stencil of one element with variables 0 to count - 1.
Stencils all_modes(Index count);

/// The nearest positive semidefinite matrix: negative eigenvalues set to zero.
Matrix semidefinite_part(const Matrix& symmetric);

}  // namespace taut
