#include "dynamics/modal/modal_integrator.h"

#include <Eigen/Cholesky>
#include <stdexcept>

namespace taut {

ModalIntegrator::ModalIntegrator(std::shared_ptr<const ModalBasis> basis, NewmarkRule rule, Vector damping,
                                 const std::vector<WarpedPosition::Held>& held, int iterations)
    : basis_(std::move(basis)),
      rule_(rule),
      damping_(std::move(damping)),
      positions_("held", "body", 1, basis_, held, 1),
      iterations_(iterations) {
  const Index modes = basis_->modes(), rows = static_cast<Index>(held.size());
  if (damping_.size() != modes) {
    throw std::invalid_argument("ModalIntegrator: damping has " + std::to_string(damping_.size()) +
                                " entries, expected " + std::to_string(modes));
  }
  const double h = rule_.step;
  inverse_ = (1 + (rule_.gamma * h * damping_ + rule_.beta * h * h * basis_->eigenvalues).array()).inverse();
  state_ = {Vector::Zero(modes), Vector::Zero(modes), Vector::Zero(modes)};
  forces_ = values_ = Vector::Zero(rows);
  jacobian_.resize(modes, rows);  // transposed, so that a row of J is a column
  scaled_.resize(modes, rows);
  schur_.resize(rows, rows);
}

void ModalIntegrator::step(const Vector& force, const Vector& targets) {
  if (force.size() != inverse_.size() || targets.size() != forces_.size()) {
    throw std::invalid_argument("ModalIntegrator: " + std::to_string(force.size()) + " forces and " +
                                std::to_string(targets.size()) + " targets, expected " +
                                std::to_string(inverse_.size()) + " and " + std::to_string(forces_.size()));
  }
  const SpectralState predicted = newmark_step(rule_, state_, Vector::Zero(force.size()));
  const Vector free =
      inverse_.cwiseProduct(force - damping_.cwiseProduct(predicted.v) - basis_->eigenvalues.cwiseProduct(predicted.q));
  const double reach = rule_.beta * rule_.step * rule_.step;
  Vector acceleration = free, q = predicted.q;
  positions_.set_targets(targets);
  for (int k = 0; k < (forces_.size() > 0 ? iterations_ : 0); ++k) {
    for (Index row = 0; row < forces_.size(); ++row)
      positions_.evaluate(row, q.data(), &values_[row], jacobian_.col(row).data());
    scaled_.noalias() = inverse_.asDiagonal() * jacobian_;
    schur_.noalias() = jacobian_.transpose() * scaled_;
    // J q'' has to be what takes the linearised positions to their targets.
    const Vector wanted = jacobian_.transpose() * (q - predicted.q) / reach - values_ / reach;
    forces_ = schur_.ldlt().solve(wanted - jacobian_.transpose() * free);
    acceleration = free + scaled_ * forces_;
    q = predicted.q + reach * acceleration;
  }
  state_ = newmark_step(rule_, state_, acceleration);
}

}  // namespace taut
