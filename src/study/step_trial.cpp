#include "study/step_trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "core/residuals.h"
#include "problems/build.h"
#include "study/examine.h"
#include "study/machine.h"

namespace taut {
namespace {

constexpr int worst_elements_kept = 5;

bool fits(const std::vector<Vector>& multipliers, const Problem& problem) {
  const std::size_t constraints = problem.constraints.size();
  if (multipliers.size() != constraints + problem.equalities.size()) return false;
  for (std::size_t k = 0; k < problem.equalities.size(); ++k) {
    if (multipliers[constraints + k].size() != problem.equalities[k]->rows.rows()) return false;
  }
  for (std::size_t k = 0; k < constraints; ++k) {
    const Constraint& constraint = *problem.constraints[k];
    if (multipliers[k].size() != constraint.stencils().count() * constraint.rows()) return false;
  }
  return true;
}

double distance_from(double middle, double value) { return std::abs(value - middle); }

}  // namespace

StepTrials::StepTrials(const Scene& scene, Solver& solver, TrialOptions options)
    : scene_(scene), solver_(solver), options_(options), model_(build_model(scene)) {
  if (options_.repeat < 1) {
    throw std::invalid_argument("TrialOptions: repeat must be at least 1, got " + std::to_string(options_.repeat));
  }
  stepper_ = std::make_unique<Stepper>(*model_, time_options(scene));
}

StepTrials::~StepTrials() = default;

const State& StepTrials::state() const { return stepper_->state(); }

void StepTrials::accept() { stepper_->accept(latest_); }

std::string StepTrials::choose_warm_start(const Problem& problem, WarmStart& warm) const {
  const WarmStart& given = stepper_->state().warm;
  if (options_.cold) return "none";
  if (fits(given.multipliers, problem)) {
    warm = given;
    return given.multipliers.empty() ? "none" : "state";
  }
  if (!latest_solved_ || !fits(latest_.multipliers, problem)) return "none";
  warm = {latest_.multipliers, latest_.penalties, latest_.force_scale, latest_.changes};
  return "own";
}

StepTrial StepTrials::run(const State& state) {
  stepper_->restore(state);
  const Problem& problem = stepper_->prepare();
  StepTrial trial;
  trial.step = state.step + 1;
  WarmStart warm;
  trial.warm_start = choose_warm_start(problem, warm);
  const auto solve = [&](double& seconds) {
    const auto begin = std::chrono::steady_clock::now();
    Result result = solver_.solve(problem, warm, options_.budget);
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return result;
  };
  if (options_.warm_up && !warmed_up_) solve(trial.warm_up_seconds);
  warmed_up_ = true;
  std::vector<Timings> phases;
  for (int k = 0; k < options_.repeat && (k == 0 || !options_.budget.out_of_time()); ++k) {
    Result result = solve(trial.seconds.emplace_back());
    phases.push_back(result.timings);
    if (k == 0) trial.result = std::move(result);
  }
  // The phases are those of the repeat whose time is in the middle.
  std::vector<double> sorted = trial.seconds;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const auto chosen = std::min_element(trial.seconds.begin(), trial.seconds.end(), [&](double a, double b) {
    return distance_from(*middle, a) < distance_from(*middle, b);
  });
  trial.result.timings = phases[static_cast<std::size_t>(chosen - trial.seconds.begin())];
  judge(problem, trial);
  trial.peak_memory_bytes = peak_memory_bytes();
  latest_ = trial.result;
  latest_solved_ = trial.judged == Status::solved;
  return trial;
}

void StepTrials::judge(const Problem& problem, StepTrial& trial) const {
  trial.residuals = residuals(problem, trial.result);
  trial.objective = objective(problem, trial.result.x);
  trial.objective_at_start = objective(problem, problem.initial_guess);
  trial.worst_elements = worst_elements(problem, trial.result.x, worst_elements_kept);
  if (trial.residuals.within(scene_.solver.tolerance)) {
    trial.judged = Status::solved;
  } else if (trial.result.status != Status::solved) {
    trial.judged = trial.result.status;
  } else {
    trial.judged = trial.residuals.finite ? Status::stalled : Status::not_finite;
  }
  name_for_people(trial.residuals, problem, *model_);
}

std::vector<State> states_of(const Scene& scene, int steps) {
  const std::unique_ptr<Solver> solver = build_solver(scene, 1);
  StepTrials trials(scene, *solver);
  std::vector<State> states;
  while (static_cast<int>(states.size()) < steps) {
    states.push_back(trials.state());
    if (trials.run(states.back()).judged != Status::solved) break;
    trials.accept();
  }
  return states;
}

std::vector<StepTrial> compare_steps(const Scene& scene, const std::vector<State>& states, Solver& solver,
                                     const TrialOptions& options) {
  StepTrials trials(scene, solver, options);
  std::vector<StepTrial> all;
  all.reserve(states.size());
  for (const State& state : states) all.push_back(trials.run(state));
  return all;
}

}  // namespace taut
