#include "dynamics/modal/replay.h"

#include <stdexcept>
#include <string>

namespace taut {

SpectralState newmark_step(const NewmarkRule& rule, const SpectralState& state, const Vector& a) {
  const double h = rule.step, beta = rule.beta, gamma = rule.gamma;
  return {state.q + h * state.v + h * h * ((0.5 - beta) * state.a + beta * a),
          state.v + h * ((1 - gamma) * state.a + gamma * a), a};
}

Replay::Replay(NewmarkRule rule, SpectralState start, Fill fill)
    : rule_(rule), state_(std::move(start)), fill_(fill), last_(state_.a) {}

Vector Replay::predicted() const {
  if (fill_ == Fill::zero || last_.size() == 0) return Vector::Zero(state_.q.size());
  if (fill_ == Fill::hold || before_last_.size() == 0) return last_;
  return last_ + (static_cast<double>(since_ + 1) / apart_) * (last_ - before_last_);
}

void Replay::advance(const std::optional<Vector>& acceleration) {
  if (!acceleration) {
    state_ = newmark_step(rule_, state_, predicted());
    ++since_;
    return;
  }
  if (acceleration->size() != state_.q.size()) {
    throw std::invalid_argument("Replay: an acceleration has " + std::to_string(acceleration->size()) +
                                " entries, expected " + std::to_string(state_.q.size()));
  }
  state_ = newmark_step(rule_, state_, *acceleration);
  before_last_ = std::move(last_);
  last_ = *acceleration;
  apart_ = since_ + 1;
  since_ = 0;
}

void Replay::correct(SpectralState state) {
  if (state.q.size() != state_.q.size() || state.v.size() != state_.q.size() || state.a.size() != state_.q.size())
    throw std::invalid_argument("Replay: a state of another size");
  state_ = std::move(state);
}

LossLaw loss_law(const NewmarkRule& rule, int count) {
  LossLaw law;
  for (int k = 0; k < count; ++k) {
    law.displacement.push_back(k == 0 ? rule.beta : rule.gamma + 0.5 + (k - 1));
    law.velocity.push_back(k == 0 ? rule.gamma : 1);
  }
  return law;
}

}  // namespace taut
