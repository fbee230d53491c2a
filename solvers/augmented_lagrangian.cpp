#include "solvers/augmented_lagrangian.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/stopwatch.h"
#include "solvers/augmented_lagrangian_run.h"
#include "solvers/null_space_system.h"
#include "solvers/preconditioned_system.h"

namespace taut {

void AugmentedLagrangianOptions::validate() const {
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(std::string("AugmentedLagrangianOptions: ") + what);
  };
  tolerances.validate();
  newton.validate();
  central_path.validate();
  require(penalty > 0, "penalty must be positive");
  require(fixed_penalty >= 0, "fixed_penalty must be positive, or 0 for none");
  require(penalty_growth > 1, "penalty_growth must exceed 1");
  require(max_penalty_growth >= 1, "max_penalty_growth must be at least 1");
  require(wanted_decrease > 0 && wanted_decrease < 1, "wanted_decrease must be between 0 and 1");
  require(inner_tolerance_factor > 0 && inner_tolerance_factor < 1,
          "inner_tolerance_factor must be between 0 and 1 (1 and above cycles)");
  require(max_outer >= 1 && max_newton >= 1, "max_outer and max_newton must be at least 1");
  require(screening >= 0, "screening must not be negative");
  require(threads >= 1, "threads must be at least 1");
}

namespace {

std::deque<EliminatedSlack> make_slacks(const Problem& problem) {
  std::deque<EliminatedSlack> slacks;
  for (const Constraint* constraint : problem.constraints) slacks.emplace_back(*constraint);
  return slacks;
}

std::vector<const Energy*> terms(const Problem& problem, const std::deque<EliminatedSlack>& slacks) {
  std::vector<const Energy*> all = problem.energies;
  for (const EliminatedSlack& slack : slacks) all.push_back(&slack);
  return all;
}

}  // namespace

AugmentedLagrangian::Workspace::Workspace(const Problem& problem, const AugmentedLagrangianOptions& options)
    : topology(problem.topology),
      slacks(make_slacks(problem)),
      equalities(problem),
      assembly(problem.size(), terms(problem, slacks),
               options.null_space ? std::vector<int>{} : problem.fixed_variables, options.threads) {
  if (options.null_space) {
    system = std::make_unique<NullSpaceSystem>(assembly, equalities, problem, options.conjugate_gradients);
  } else if (equalities.count() > 0 && options.equalities == EqualityForm::penalised) {
    system = std::make_unique<PenalisedRowsSystem>(assembly, equalities, problem.fixed_variables, options.threads);
  } else if (equalities.count() > 0) {
    system = std::make_unique<QuasiDefiniteSystem>(assembly, equalities, problem.fixed_variables);
  } else {
    const std::vector<int> order = fill_reducing_order(assembly.graph());
    assembly.set_order(order);
    cholesky = std::make_unique<Cholesky>(assembly.matrix(), options.threads);
    if (PreconditionedSystem::pays(assembly)) {
      system = std::make_unique<PreconditionedSystem>(assembly, order, *cholesky, options.threads);
    } else {
      system = std::make_unique<SubstitutedSystem>(assembly, *cholesky);
    }
  }
}

/// True where x is so far away that the subproblem has no minimum to be found.
bool AugmentedLagrangian::Run::diverges(const Vector& x) const {
  return x.lpNorm<Eigen::Infinity>() > 1e10 * std::max(1.0, problem.initial_guess.lpNorm<Eigen::Infinity>());
}

/// Shows the observer a point with the multipliers that an update there would give. `equal` are those of the linear
/// equalities.
void AugmentedLagrangian::Run::show(const Vector& x, const Vector& equal) const {
  std::vector<Vector> multipliers(result.multipliers.size());
  double penalty = 0;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    work.slacks[k].updated_multipliers(x, std::numeric_limits<double>::infinity(), multipliers[k]);
    penalty = std::max(penalty, work.slacks[k].penalty());
  }
  work.equalities.put(equal, work.slacks.size(), multipliers);
  observer({x, multipliers, penalty, result.counts});
}

/// Minimises over x until its residual is small against the force that the multiplier update would change.
Status AugmentedLagrangian::Run::inner(NewtonState& state) {
  double smallest = 0.5 * options.tolerances.stationarity * judged.force_scale;
  int seen = 0;
  return newton.minimise(
      state,
      [&](const NewtonState& now) {
        if (observer) show(now.x, now.multipliers);
        // Without constraints nothing else looks at the forces again, which may be much larger than at the start: thin
        // shells would be asked for a balance below their round-off.
        if (!constrained() && ++seen % 8 == 0) {
          result.x = now.x;
          work.equalities.put(now.multipliers, work.slacks.size(), result.multipliers);
          judged = residuals(problem, result);
          smallest = 0.5 * options.tolerances.stationarity * judged.force_scale;
        }
        if (now.nodal_norm <= smallest || diverges(now.x)) return true;
        if (linear_solves() >= options.max_newton) return true;
        scratch.setZero(problem.size());
        for (const EliminatedSlack& slack : work.slacks) slack.add_update_force(now.x, scratch);
        for (int variable : problem.fixed_variables) scratch[variable] = 0;
        return now.nodal_norm <= options.inner_tolerance_factor * nodal_max_norm(scratch, problem.node_size);
      },
      budget, result.counts, result.timings);
}

/// lambda <- lambda+ at x, and judges the outcome.
void AugmentedLagrangian::Run::update(const NewtonState& state) {
  result.x = state.x;
  work.equalities.put(state.multipliers, work.slacks.size(), result.multipliers);
  ++result.counts.outer;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    EliminatedSlack& slack = work.slacks[k];
    // Constraint values are of order one (squared stretches) or the scene's size, so this bounds lambda far above any
    // feasible problem's.
    const double cap = 1e6 * start_penalty[k] * slack.constraint().violation_scale();
    slack.updated_multipliers(state.x, cap, result.multipliers[k]);
    slack.set_multipliers(result.multipliers[k]);
  }
  judged = residuals(problem, result);
}

/// Raises the penalty of each constraint whose violation did not fall as wanted; false where one that should be raised
/// cannot be.
bool AugmentedLagrangian::Run::update_penalties() {
  bool room = true;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    const double relative = judged.violations[k].max / work.slacks[k].constraint().violation_scale();
    const bool too_slow =
        relative > options.tolerances.feasibility && relative > options.wanted_decrease * last_violation[k];
    last_violation[k] = relative;
    if (!too_slow) continue;
    if (options.fixed_penalty > 0) continue;
    const double grown = work.slacks[k].penalty() * options.penalty_growth;
    if (grown > options.max_penalty_growth * start_penalty[k]) {
      room = false;
    } else {
      work.slacks[k].set_penalty(grown);
    }
  }
  return room;
}

void AugmentedLagrangian::Run::loop() {
  if (central_path()) {
    result.status = Status::solved;
    result.message = "residuals within tolerance, along the central path";
    return;
  }
  NewtonState state;
  state.x = result.x;
  state.multipliers = work.equalities.stacked(result.multipliers, work.slacks.size());
  last_violation.assign(work.slacks.size(), std::numeric_limits<double>::infinity());
  Result best = result;
  Residuals best_judged = judged;
  best_judged.finite = false;
  double first_violation = -1;
  int stalls = 0, without_progress = 0, failures = 0;
  double near = 1e-3;  // the residuals at which the central path is tried again

  const auto finish = [&](Status status, std::string message) {
    if (status != Status::solved && status != Status::infeasible &&
        best_judged.over(options.tolerances) < judged.over(options.tolerances)) {
      result.x = best.x;
      result.multipliers = best.multipliers;
      judged = best_judged;
    }
    result.status = status;
    result.message = std::move(message);
  };

  while (true) {
    const Status inner_status = inner(state);
    if (inner_status == Status::not_finite || diverges(state.x)) {
      if (++failures <= 3 && options.fixed_penalty == 0 && !work.slacks.empty()) {
        // A subproblem without a minimum says nothing about the multipliers; a larger penalty may give it one.
        for (std::size_t k = 0; k < work.slacks.size(); ++k) {
          start_penalty[k] *= 1e3;
          work.slacks[k].set_penalty(start_penalty[k]);
        }
        state.x = result.x;
        state.multipliers = work.equalities.stacked(result.multipliers, work.slacks.size());
        continue;
      }
      if (inner_status == Status::not_finite)
        return finish(inner_status, "a value, a force or a Newton step is not finite");
      update(state);
      const double distance = std::max(1.0, state.x.lpNorm<Eigen::Infinity>());
      if (judged.feasibility <= options.tolerances.feasibility * distance)
        return finish(Status::unbounded, "the objective falls without end while the constraints hold");
      return finish(Status::stalled, "the iterates leave every bound without meeting the constraints");
    }
    update(state);
    if (left_out_violated()) return finish(Status::stalled, "a constraint that was left out is violated");
    if (judged.over(options.tolerances) < best_judged.over(options.tolerances)) {
      best.x = result.x;
      best.multipliers = result.multipliers;
      best_judged = judged;
    }
    if (judged.within(options.tolerances)) return finish(Status::solved, "residuals within tolerance");
    if (newton_finish()) return finish(Status::solved, "residuals within tolerance, by Newton steps on all of them");
    // The path that was lost far away may be found from here. (In models Newton's finish serves better: docs/theory.)
    if (!options.newton_finish && judged.within({near, near, near})) {
      near *= 1e-2;
      if (central_path()) return finish(Status::solved, "residuals within tolerance, along the central path");
    }
    if (inner_status == Status::interrupted) return finish(inner_status, "stopped on request");
    if (inner_status == Status::time_limit) return finish(inner_status, "out of time");
    if (result.counts.outer - before_again.outer >= options.max_outer || linear_solves() >= options.max_newton) {
      return finish(Status::iteration_limit, "iterations used up");
    }
    stalls = inner_status == Status::stalled ? stalls + 1 : 0;
    if (stalls >= 3) return finish(Status::stalled, "the line search finds no further decrease");

    const bool falling = first_violation < 0 || judged.feasibility <= 0.5 * first_violation;
    without_progress = falling || judged.feasibility <= options.tolerances.feasibility ? 0 : without_progress + 1;
    if (falling) first_violation = judged.feasibility;
    const bool room = update_penalties();
    // A penalty fixed too low looks the same as an infeasible problem.
    if (options.fixed_penalty == 0 && (!room || without_progress >= 4)) {
      std::vector<double> grown;
      for (const EliminatedSlack& slack : work.slacks) grown.push_back(slack.penalty());
      const bool compromise = closest_compromise(state);
      // A point that was much closer tells that there is more to gain.
      const bool closest = best_judged.feasibility > 0.5 * judged.feasibility;
      if (compromise && closest) {
        result.multipliers = best.multipliers;
        work.equalities.put(state.multipliers, work.slacks.size(), result.multipliers);
        judged = residuals(problem, result);
        return finish(Status::infeasible, "no nearby point satisfies the constraints; this is the closest compromise");
      }
      for (std::size_t k = 0; k < work.slacks.size(); ++k) {
        if (!closest) work.slacks[k].set_multipliers(best.multipliers[k]);
        work.slacks[k].set_penalty(closest ? grown[k] : start_penalty[k]);
      }
      if (!closest) {
        state.x = best.x;
        state.multipliers = work.equalities.stacked(best.multipliers, work.slacks.size());
      }
      if (!room) return finish(Status::stalled, "penalty at its limit");
      without_progress = 0;
      first_violation = -1;
    }
  }
}

AugmentedLagrangian::AugmentedLagrangian(AugmentedLagrangianOptions options) : options_(options) {
  options_.validate();
}
AugmentedLagrangian::~AugmentedLagrangian() = default;

NewtonSystem::Size AugmentedLagrangian::size() const {
  if (!workspace_) return {};
  NewtonSystem::Size total = workspace_->system->size();
  total.bytes += workspace_->assembly.memory_bytes();
  return total;
}

Result AugmentedLagrangian::solve(const Problem& problem, const WarmStart& warm, const Budget& budget) {
  double total = 0, analysis = 0;
  bool analysed = false;
  Result result;
  {
    const Stopwatch watch(total);
    if (!workspace_ || workspace_->topology == 0 || workspace_->topology != problem.topology) {
      const Stopwatch analysis_watch(analysis);
      problem.validate();
      workspace_.reset();
      workspace_ = std::make_unique<Workspace>(problem, options_);
      analysed = true;
    }
    NewtonSystem& system = *workspace_->system;
    const NewtonSystem::Effort before = system.effort();
    system.start();
    Run run(options_, problem, budget, observer, *workspace_);
    run.solve(warm);
    result = std::move(run.result);
    if (analysed) ++result.counts.symbolic_analyses;
    const NewtonSystem::Effort after = system.effort();
    result.counts.pivoted_factorizations = after.pivoted - before.pivoted;
    result.counts.inner_iterations = after.iterations - before.iterations;
    result.counts.factor_flops = after.more_flops - before.more_flops;
    result.counts.factorizations += after.refactorized - before.refactorized;
    if (before.pivoted == 0 && result.counts.pivoted_factorizations > 0) ++result.counts.symbolic_analyses;
    result.force_scale = run.judged.force_scale;
  }
  result.timings.total = total;
  result.timings.analysis = analysis;
  if (const auto factorizations = static_cast<double>(result.counts.factorizations); factorizations > 0)
    result.counts.factor_flops += factorizations * size().factor_flops;
  result.counts.matrix_allocations = analysed ? 1 : 0;
  return result;
}

}  // namespace taut
