#pragma once

#include <memory>
#include <vector>

#include "dynamics/modal/modal_basis.h"
#include "dynamics/modal/replay.h"
#include "dynamics/modal/warped_position.h"

namespace taut {

/// Steps of a modal body whose held coordinates follow targets, by Lagrange multipliers (MW (A.7)-(A.17), corrected):
/// one linear system a step, for uses that need it in microseconds. The rescaled system
///
///   [A -J^T; -J 0] [q''; f] = [b; (x(q~) - c)/(beta h^2)],  A = 1 + gamma h C_q + beta h^2 K_q,
///
/// with the exact Jacobian J of the warped positions is well conditioned whatever h is, and its multipliers f are the
/// forces on the held coordinates, in N. A is diagonal, so that only its Schur complement is factorised. The constraint
/// is linearised at the predictor; more `iterations` are Newton's method on it. The Problem of the same step
/// (WarpedPosition in a Stepper) goes on until its residuals are within tolerance.
class ModalIntegrator {
 public:
  /// `damping` C_q has one entry per mode, 1/s. Starts at rest, at q = 0.
  ModalIntegrator(std::shared_ptr<const ModalBasis> basis, NewmarkRule rule, Vector damping,
                  const std::vector<WarpedPosition::Held>& held, int iterations = 1);

  const SpectralState& state() const { return state_; }
  void restore(SpectralState state) { state_ = std::move(state); }
  /// `force`: Phi^T (dx/dd)^T f of the applied forces at the predictor, one entry per mode; `targets`: of the held
  /// coordinates, m. Throws std::invalid_argument for other sizes.
  void step(const Vector& force, const Vector& targets);
  /// On the held coordinates in the last step, by what holds them, N.
  const Vector& forces() const { return forces_; }

 private:
  std::shared_ptr<const ModalBasis> basis_;
  NewmarkRule rule_;
  Vector damping_, inverse_;  // C_q, 1/A
  WarpedPosition positions_;
  int iterations_;
  SpectralState state_;
  Vector forces_, values_;
  Matrix jacobian_, scaled_, schur_;
};

}  // namespace taut
