#include "solvers/newton.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/stopwatch.h"

namespace taut {

namespace {
const EqualityRows no_equalities;
}  // namespace

void NewtonOptions::validate() const {
  if (max_iterations < 1) throw std::invalid_argument("NewtonOptions: max_iterations must be at least 1");
  if (max_halvings < 1) throw std::invalid_argument("NewtonOptions: max_halvings must be at least 1");
  if (!(sufficient_decrease > 0 && sufficient_decrease < 0.5)) {
    throw std::invalid_argument("NewtonOptions: sufficient_decrease must be between 0 and 0.5");
  }
  if (!(guard > 0 && guard < 1)) throw std::invalid_argument("NewtonOptions: guard must be between 0 and 1");
}

double believable_fraction(const Vector& x, const Vector& step, double longest_step) {
  if (!std::isfinite(longest_step) || step.isZero(0)) return 1;
  const double allowed = longest_step * std::max(1.0, x.lpNorm<Eigen::Infinity>());
  return std::min(1.0, allowed / step.lpNorm<Eigen::Infinity>());
}

double nodal_max_norm(const Vector& force, int node_size) {
  double largest = 0;
  for (Index first = 0; first < force.size(); first += node_size) {
    const double square = force.segment(first, node_size).squaredNorm();
    if (!(square <= largest)) largest = square;
  }
  return std::sqrt(largest);
}

bool SubstitutedSystem::solve(const Vector& gradient, const Vector& /*violation*/, Vector& step,
                              Vector& multiplier_step) {
  multiplier_step.resize(0);
  assembly_.to_ordered(gradient, right_hand_side_);
  cholesky_.solve(right_hand_side_, solution_);
  assembly_.from_ordered(solution_, step);
  step = -step;
  return true;
}

Newton::Newton(Assembly& assembly, NewtonSystem& system, const EqualityRows& equalities, const std::vector<int>& fixed,
               int node_size, NewtonOptions options)
    : assembly_(assembly),
      system_(system),
      equalities_(equalities),
      fixed_(fixed),
      node_size_(node_size),
      options_(options) {
  options_.validate();
}

Newton::Newton(Assembly& assembly, NewtonSystem& system, const std::vector<int>& fixed, int node_size,
               NewtonOptions options)
    : Newton(assembly, system, no_equalities, fixed, node_size, options) {}

void Newton::evaluate(NewtonState& state, Counts& counts, Timings& timings) {
  const Stopwatch watch(timings.assembly);
  ++counts.function_evaluations;
  state.value = assembly_.gradient(state.x, state.gradient);
  equalities_.add_force(state.multipliers, state.gradient);
  equalities_.violation(state.x, state.violation);
  for (int variable : fixed_) state.gradient[variable] = 0;
  state.nodal_norm = nodal_max_norm(state.gradient, node_size_);
}

/// The step of the exact Hessian that the assembly holds, shifted as little as makes it positive definite; false where
/// the shift would be larger than its diagonal. The last shift, a third of it, is tried first [Waechter and Biegler
/// 2006, 3.1].
bool Newton::shifted_step(const std::function<bool(double)>& solve) {
  const double unit = assembly_.matrix().diagonal().cwiseAbs().mean();
  double shift = shift_ > 1e-5 * unit ? shift_ / 3 : 0;
  for (shift_ = 0; shift <= unit; shift = std::max(4 * shift, 1e-4 * unit)) {
    if (!solve(shift)) continue;
    shift_ = shift;
    return true;
  }
  return false;
}

/// Solves H step = -gradient with the best Hessian that is positive definite; false where none is found.
bool Newton::direction(const NewtonState& state, Counts& counts, Timings& timings) {
  const auto solve = [&](double shift) {
    {
      const Stopwatch watch(timings.factorization);
      ++counts.factorizations;
      if (!system_.factorize(shift)) return false;
    }
    const Stopwatch watch(timings.solve);
    ++counts.linear_solves;
    return system_.solve(state.gradient, state.violation, step_, multiplier_step_);
  };
  const auto assemble = [&](Curvature curvature) {
    const Stopwatch watch(timings.assembly);
    assembly_.hessian(state.x, curvature);
  };
  const bool try_exact = curvature_ == Curvature::exact || wait_ == 0;
  bool positive = false;
  if (try_exact) {
    assemble(Curvature::exact);
    positive = equalities_.count() > 0 ? shifted_step(solve) : solve(0);
    curvature_ = positive ? Curvature::exact : Curvature::positive_semidefinite;
    if (!positive) {
      wait_ = patience_;
      patience_ = std::min(2 * patience_, 64);
    }
  }
  if (!positive) {
    --wait_;
    assemble(Curvature::positive_semidefinite);
    // A matrix that is singular but for round-off has a factor, but no line search comes back from its steps.
    positive = solve(0) && step_.lpNorm<Eigen::Infinity>() <= 1e10 * std::max(1.0, state.x.lpNorm<Eigen::Infinity>());
    double shift = 0;
    for (int attempt = 0; !positive && attempt < 12; ++attempt) {
      // Relative to the stiffest entry: 1e-10, 1e-9, ... Where all are zero, the gradient is followed.
      const double stiffest = assembly_.matrix().coeffs().abs().maxCoeff();
      shift = shift > 0 ? 10 * shift : 1e-10 * (stiffest > 0 ? stiffest : 1.0);
      if (!std::isfinite(shift)) return false;
      positive = solve(shift);
    }
  }
  return positive && step_.allFinite() && multiplier_step_.allFinite();
}

/// Moves `state` along step_; false where no fraction of it decreases the value.
bool Newton::line_search(NewtonState& state, Counts& counts, Timings& timings) {
  double slope = state.gradient.dot(step_);
  if (!state.violation.isZero(0)) {
    // The gradient has A^T nu in it, of which the value knows nothing: nu . A step = -nu . violation.
    weight_ = std::max(weight_, 2 * (state.multipliers + multiplier_step_).lpNorm<Eigen::Infinity>());
    slope += state.multipliers.dot(state.violation) - weight_ * state.violation.lpNorm<1>();
  }
  if (!(slope < 0)) return false;
  const double start = merit(state);
  // Differences of the value below this are round-off; there the gradient decides.
  const double noise = 1e-13 * std::abs(start) + 1e-300;
  double fraction = std::min(believable_fraction(state.x, step_, options_.longest_step),
                             options_.guard * assembly_.largest_step(state.x, step_));
  const double gradient_norm = state.gradient.norm();
  for (int halving = 0; halving < options_.max_halvings; ++halving, fraction *= 0.5) {
    trial_.x = state.x + fraction * step_;
    trial_.multipliers = state.multipliers + fraction * multiplier_step_;
    evaluate(trial_, counts, timings);
    if (!std::isfinite(trial_.value) || !std::isfinite(trial_.nodal_norm)) continue;
    const double wanted = options_.sufficient_decrease * fraction * slope;
    const bool decreased = merit(trial_) <= start + wanted;
    const bool in_noise = merit(trial_) <= start + noise && trial_.gradient.norm() <= gradient_norm;
    if (decreased || in_noise) {
      std::swap(state, trial_);
      return true;
    }
  }
  return false;
}

Status Newton::minimise(NewtonState& state, const std::function<bool(const NewtonState&)>& done, const Budget& budget,
                        Counts& counts, Timings& timings) {
  if (state.multipliers.size() != equalities_.count()) state.multipliers.setZero(equalities_.count());
  evaluate(state, counts, timings);
  weight_ = 0;
  if (!std::isfinite(state.value) || !std::isfinite(state.nodal_norm)) return Status::not_finite;
  for (int iteration = 0;; ++iteration) {
    if (state.violation.isZero(0) && done(state)) return Status::solved;
    if (iteration == options_.max_iterations) return Status::iteration_limit;
    if (budget.interrupted()) return Status::interrupted;
    if (budget.out_of_time()) return Status::time_limit;
    if (!direction(state, counts, timings)) return Status::not_finite;
    if (!line_search(state, counts, timings)) {
      if (curvature_ == Curvature::positive_semidefinite) return Status::stalled;
      curvature_ = Curvature::positive_semidefinite;
      wait_ = patience_;
      patience_ = std::min(2 * patience_, 64);
    }
  }
}

}  // namespace taut
