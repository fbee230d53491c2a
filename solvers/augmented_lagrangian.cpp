#include "solvers/augmented_lagrangian.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <stdexcept>

#include "core/stopwatch.h"
#include "solvers/eliminated_slack.h"
#include "solvers/equality_system.h"
#include "solvers/null_space_system.h"

namespace taut {
namespace {

/// Replaces `projected` by the multipliers of `slack`, but zero in elements where `projected` is zero and the norm is
/// below 1e-6 of the largest.
void keep_significant(const EliminatedSlack& slack, Vector& projected) {
  const Vector& own = slack.multipliers();
  const int rows = slack.constraint().rows();
  double largest = 0;
  for (Index first = 0; first < own.size(); first += rows) largest = std::max(largest, own.segment(first, rows).norm());
  for (Index first = 0; first < own.size(); first += rows) {
    const bool negligible =
        projected.segment(first, rows).isZero(0) && own.segment(first, rows).norm() <= 1e-6 * largest;
    if (!negligible) projected.segment(first, rows) = own.segment(first, rows);
  }
}

}  // namespace

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

/// What is kept from solve to solve of the same topology.
struct AugmentedLagrangian::Workspace {
  std::uint64_t topology = 0;
  std::deque<EliminatedSlack> slacks;
  EqualityRows equalities;
  Assembly assembly;
  std::unique_ptr<Cholesky> cholesky;  // null with equalities or the null space
  std::unique_ptr<NewtonSystem> system;

  Workspace(const Problem& problem, bool null_space, bool conjugate_gradients, EqualityForm form, int threads)
      : topology(problem.topology),
        slacks(problem.constraints.size() ? make_slacks(problem) : std::deque<EliminatedSlack>{}),
        equalities(problem),
        assembly(problem.size(), terms(problem), null_space ? std::vector<int>{} : problem.fixed_variables, threads) {
    if (null_space) {
      system = std::make_unique<NullSpaceSystem>(assembly, equalities, problem, conjugate_gradients);
    } else if (equalities.count() > 0 && form == EqualityForm::penalised) {
      system = std::make_unique<PenalisedRowsSystem>(assembly, equalities, problem.fixed_variables, threads);
    } else if (equalities.count() > 0) {
      system = std::make_unique<QuasiDefiniteSystem>(assembly, equalities, problem.fixed_variables);
    } else {
      assembly.set_order(fill_reducing_order(assembly.graph()));
      cholesky = std::make_unique<Cholesky>(assembly.matrix(), threads);
      system = std::make_unique<SubstitutedSystem>(assembly, *cholesky);
    }
  }

  static std::deque<EliminatedSlack> make_slacks(const Problem& problem) {
    std::deque<EliminatedSlack> slacks;
    for (const Constraint* constraint : problem.constraints) slacks.emplace_back(*constraint);
    return slacks;
  }
  std::vector<const Energy*> terms(const Problem& problem) const {
    std::vector<const Energy*> all = problem.energies;
    for (const EliminatedSlack& slack : slacks) all.push_back(&slack);
    return all;
  }
};

/// One call of solve().
struct AugmentedLagrangian::Run {
  const AugmentedLagrangianOptions& options;
  const Problem& problem;
  const Budget& budget;
  const std::function<void(const Iterate&)>& observer;
  Workspace& work;
  Newton newton;
  Result result;     // what is being improved
  Residuals judged;  // of `result`
  std::vector<double> start_penalty;
  std::vector<double> last_violation;
  Vector scratch;
  Index left_out = 0;  // slacks

  Run(const AugmentedLagrangianOptions& o, const Problem& p, const Budget& b,
      const std::function<void(const Iterate&)>& f, Workspace& w)
      : options(o),
        problem(p),
        budget(b),
        observer(f),
        work(w),
        newton(w.assembly, *w.system, w.equalities, p.fixed_variables, p.node_size, o.newton) {}

  void solve(const WarmStart& warm);
  void start(const WarmStart& warm);
  void leave_out(const WarmStart& warm);
  bool left_out_violated() const;
  bool constrained() const { return left_out < static_cast<Index>(work.slacks.size()); }
  double automatic_penalty(const Constraint& constraint) const;
  void show(const Vector& x, const Vector& equal) const;
  Status inner(NewtonState& state);
  bool diverges(const Vector& x) const;
  void update(const NewtonState& state);
  bool update_penalties();
  bool penalise(double growth, double tolerance, NewtonState& state);
  bool closest_compromise(NewtonState& state);
  bool central_path();
  void loop();
  double merit(const Residuals& residuals) const;
};

/// The ratio of the diagonals that energies and this constraint's J^T w J put on the variables it touches: the penalty
/// at which both are equally stiff.
double AugmentedLagrangian::Run::automatic_penalty(const Constraint& constraint) const {
  std::array<double, max_stencil_width> local, gradient;
  std::array<double, max_rows> c;
  std::vector<double> jacobian(max_rows * max_stencil_width), hessian(max_stencil_width * max_stencil_width);
  Vector touched = Vector::Zero(problem.size());
  const Stencils& stencils = constraint.stencils();
  for (Index element = 0; element < stencils.count(); ++element) {
    stencils.gather(element, result.x, local.data());
    constraint.evaluate(element, local.data(), c.data(), jacobian.data());
    for (int k = 0; k < stencils.width(); ++k) {
      const double square =
          Eigen::Map<const Vector>(jacobian.data() + k * constraint.rows(), constraint.rows()).squaredNorm();
      touched[stencils[element][k]] += constraint.weight(element) * square;
    }
  }
  for (int variable : problem.fixed_variables) touched[variable] = 0;
  double stiffness = 0;
  for (const Energy* energy : problem.energies) {
    if (!energy->has_curvature()) continue;
    const int width = energy->stencils().width();
    for (Index element = 0; element < energy->stencils().count(); ++element) {
      energy->stencils().gather(element, result.x, local.data());
      energy->evaluate(element, local.data(), gradient.data(), hessian.data(), Curvature::positive_semidefinite);
      for (int k = 0; k < width; ++k) {
        if (touched[energy->stencils()[element][k]] > 0) stiffness += hessian[static_cast<std::size_t>(k * width + k)];
      }
    }
  }
  const double rows = touched.sum();
  return rows > 0 && stiffness > 0 && std::isfinite(stiffness / rows) ? stiffness / rows : 1.0;
}

void AugmentedLagrangian::Run::start(const WarmStart& warm) {
  result.x = problem.initial_guess;
  for (std::size_t i = 0; i < problem.fixed_variables.size(); ++i) {
    result.x[problem.fixed_variables[i]] = problem.fixed_values[static_cast<Index>(i)];
  }
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    EliminatedSlack& slack = work.slacks[k];
    slack.set_left_out(false);
    const Index rows = slack.multipliers().size();
    slack.set_multipliers(options.warm_multipliers && k < warm.multipliers.size() ? warm.multipliers[k]
                                                                                  : Vector(Vector::Zero(rows)));
    const double automatic = options.fixed_penalty > 0 ? options.fixed_penalty
                             : k < warm.penalties.size() && warm.penalties[k] > 0
                                 ? warm.penalties[k]
                                 : options.penalty * automatic_penalty(slack.constraint());
    slack.set_penalty(automatic);
    start_penalty.push_back(automatic);
    result.multipliers.push_back(slack.multipliers());
    result.penalties.push_back(automatic);
  }
  work.equalities.update(problem);
  const Vector equal = work.equalities.stacked(warm.multipliers, work.slacks.size());
  work.equalities.put(options.warm_multipliers ? equal : Vector(Vector::Zero(equal.size())), work.slacks.size(),
                      result.multipliers);
  // Of the start only the scale of its forces is wanted, and the last step's is as good.
  if (warm.force_scale > 0 && std::isfinite(warm.force_scale) && !work.slacks.empty()) {
    judged.force_scale = warm.force_scale;
  } else {
    judged = residuals(problem, result);
  }
}

/// Leaves out the constraints that were inactive, where no element of the initial guess is nearer to its boundary than
/// `screening` times the largest change of any element in the last solve. That is a guess, not a bound: solve() looks.
void AugmentedLagrangian::Run::leave_out(const WarmStart& warm) {
  if (options.screening == 0 || warm.changes.size() != work.slacks.size()) return;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    EliminatedSlack& slack = work.slacks[k];
    if (!slack.multipliers().isZero(0) || !slack.is_far_inside(result.x, options.screening * warm.changes[k])) continue;
    slack.set_left_out(true);
    ++left_out;
  }
}

/// True where `judged` has found a constraint violated that was left out, by however little.
bool AugmentedLagrangian::Run::left_out_violated() const {
  for (std::size_t k = 0; left_out > 0 && k < work.slacks.size(); ++k) {
    if (work.slacks[k].left_out() && !(judged.violations[k].max <= 0)) return true;
  }
  return false;
}

void AugmentedLagrangian::Run::solve(const WarmStart& warm) {
  start(warm);
  const Vector guess = result.x;
  leave_out(warm);
  result.counts.screened = left_out;
  loop();
  const bool cut_off = result.status == Status::interrupted || result.status == Status::time_limit;
  if (left_out > 0 && !cut_off && (result.status != Status::solved || left_out_violated())) {
    // The point with its constraints back is what a solve without screening would start from.
    left_out = 0;
    result.multipliers.clear();
    result.penalties.clear();
    start_penalty.clear();
    start(warm);
    ++result.counts.screening_failures;
    result.counts.screened = 0;
    loop();
  }
  for (const EliminatedSlack& slack : work.slacks) result.changes.push_back(slack.largest_change(guess, result.x));
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
          work.equalities.put(now.multipliers, 0, result.multipliers);
          judged = residuals(problem, result);
          smallest = 0.5 * options.tolerances.stationarity * judged.force_scale;
        }
        if (now.nodal_norm <= smallest || diverges(now.x)) return true;
        if (result.counts.linear_solves >= options.max_newton) return true;
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

double AugmentedLagrangian::Run::merit(const Residuals& r) const {
  if (!r.finite) return std::numeric_limits<double>::infinity();
  const Tolerances& t = options.tolerances;
  return std::max(
      {r.stationarity / t.stationarity, r.feasibility / t.feasibility, r.complementarity / t.complementarity});
}

/// Minimises the energies and a penalty on the violation, `growth` times that of the start, from state.x; until
/// forces balance to `tolerance`; the slacks get the multipliers that belong to it. False where that fails by far.
bool AugmentedLagrangian::Run::penalise(double growth, double tolerance, NewtonState& state) {
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    work.slacks[k].set_multipliers(Vector::Zero(work.slacks[k].multipliers().size()));
    work.slacks[k].set_penalty(growth * start_penalty[k]);
  }
  double scale = 0;
  newton.minimise(
      state,
      [&](const NewtonState& now) {
        // The forces of the penalised violation, term by term, are the scale on which their sum has to vanish.
        Result probe;
        probe.x = now.x;
        for (const EliminatedSlack& slack : work.slacks) {
          probe.multipliers.emplace_back();
          slack.updated_multipliers(now.x, std::numeric_limits<double>::infinity(), probe.multipliers.back());
        }
        work.equalities.put(now.multipliers, work.slacks.size(), probe.multipliers);
        scale = residuals(problem, probe).force_scale;
        return now.nodal_norm <= tolerance * scale || result.counts.linear_solves >= options.max_newton;
      },
      budget, result.counts, result.timings);
  for (EliminatedSlack& slack : work.slacks) {
    Vector stiff;
    slack.updated_multipliers(state.x, std::numeric_limits<double>::infinity(), stiff);
    slack.set_multipliers(stiff);
  }
  return state.nodal_norm <= 10 * tolerance * scale;
}

/// Minimises the violation from state.x, with the energies as a weak tie-breaker; true where that leaves it violated
/// and stationary: the residuals are then those of the compromise, in `judged`.
///
/// A penalty finite as it is, the energies violate feasible constraints, too, by lambda / mu. So a second one, a
/// hundred times as large, has to leave the violation c as it is. Forces balance at both, mu J^T c = -grad f, and grad
/// f is bounded, so that |J^T c| has fallen to a hundredth while |c| has not.
bool AugmentedLagrangian::Run::closest_compromise(NewtonState& state) {
  const auto violation = [&] {
    result.x = state.x;
    work.equalities.put(state.multipliers, work.slacks.size(), result.multipliers);
    judged = residuals(problem, result);
    return judged.feasibility;
  };
  if (!penalise(1e3, 1e-4, state)) return false;
  const double first = violation();
  if (first <= options.tolerances.feasibility) return false;
  const bool balanced = penalise(1e5, 1e-6, state);
  const double second = violation();
  return balanced && second > 0.5 * first && second > options.tolerances.feasibility;
}

/// Tries the central path from the warm start; on success `result` and `judged` hold the solution, else the warm start
/// is restored.
bool AugmentedLagrangian::Run::central_path() {
  if (!options.central_path.enabled || options.null_space || !constrained()) return false;
  const Result start = result;
  const Residuals start_judged = judged;
  for (EliminatedSlack& slack : work.slacks) slack.set_penalty(options.central_path.penalty_fraction * slack.penalty());
  Vector x = result.x, equal = work.equalities.stacked(result.multipliers, work.slacks.size());
  const bool solved = follow_central_path(
      work.assembly, *work.system, work.equalities, work.slacks, problem.node_size, judged.force_scale,
      options.tolerances, options.central_path, options.threads, x, equal,
      [&](const Vector& candidate) {
        result.x = candidate;
        const Judge judge(problem, result.x);
        // Projected multipliers vanish where a constraint is not active; the path's own are positive everywhere, but
        // where many are weak their forces balance better, so they come second, without those that are negligible.
        for (std::size_t k = 0; k < work.slacks.size(); ++k) {
          work.slacks[k].updated_multipliers(candidate, std::numeric_limits<double>::infinity(), result.multipliers[k]);
        }
        work.equalities.put(equal, work.slacks.size(), result.multipliers);
        judged = judge(result.multipliers);
        if (judged.within(options.tolerances)) return merit(judged);
        for (std::size_t k = 0; k < work.slacks.size(); ++k) keep_significant(work.slacks[k], result.multipliers[k]);
        judged = judge(result.multipliers);
        return merit(judged);
      },
      observer ? [&](const Vector& now) { show(now, equal); } : std::function<void(const Vector&)>(), budget,
      result.counts, result.timings);
  for (std::size_t k = 0; k < work.slacks.size(); ++k) work.slacks[k].set_penalty(start_penalty[k]);
  if (solved) return true;
  result.x = start.x;
  result.multipliers = start.multipliers;
  judged = start_judged;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) work.slacks[k].set_multipliers(start.multipliers[k]);
  return false;
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

  const auto finish = [&](Status status, std::string message) {
    if (status != Status::solved && status != Status::infeasible && merit(best_judged) < merit(judged)) {
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
    if (merit(judged) < merit(best_judged)) {
      best.x = result.x;
      best.multipliers = result.multipliers;
      best_judged = judged;
    }
    if (judged.within(options.tolerances)) return finish(Status::solved, "residuals within tolerance");
    if (inner_status == Status::interrupted) return finish(inner_status, "stopped on request");
    if (inner_status == Status::time_limit) return finish(inner_status, "out of time");
    if (result.counts.outer >= options.max_outer || result.counts.linear_solves >= options.max_newton) {
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
      workspace_ = std::make_unique<Workspace>(problem, options_.null_space, options_.conjugate_gradients,
                                               options_.equalities, options_.threads);
      analysed = true;
    }
    const Index pivoted = workspace_->system->pivoted();
    Run run(options_, problem, budget, observer, *workspace_);
    run.solve(warm);
    result = std::move(run.result);
    if (analysed) ++result.counts.symbolic_analyses;
    result.counts.pivoted_factorizations = workspace_->system->pivoted() - pivoted;
    if (pivoted == 0 && result.counts.pivoted_factorizations > 0) ++result.counts.symbolic_analyses;
    result.force_scale = run.judged.force_scale;
  }
  result.timings.total = total;
  result.timings.analysis = analysis;
  if (const auto factorizations = static_cast<double>(result.counts.factorizations); factorizations > 0)
    result.counts.factor_flops = factorizations * size().factor_flops;
  result.counts.matrix_allocations = analysed ? 1 : 0;
  return result;
}

}  // namespace taut
