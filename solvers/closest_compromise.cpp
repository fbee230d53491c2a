#include <limits>

#include "solvers/augmented_lagrangian_run.h"

namespace taut {

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
        return now.nodal_norm <= tolerance * scale || linear_solves() >= options.max_newton;
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

}  // namespace taut
