#include <algorithm>
#include <limits>

#include "core/stopwatch.h"
#include "solvers/augmented_lagrangian_run.h"

namespace taut {

/// One step of the finish from `result`, with the factor that the system holds; false where the step leaves what guards
/// it or is no number.
bool AugmentedLagrangian::Run::newton_step() {
  Vector gradient, violation, step, equal_step;
  Vector equal = work.equalities.stacked(result.multipliers, work.slacks.size());
  {
    const Stopwatch watch(result.timings.assembly);
    ++result.counts.function_evaluations;
    work.assembly.gradient(result.x, gradient);
    work.equalities.add_force(equal, gradient);
    work.equalities.violation(result.x, violation);
    work.assembly.clear_fixed(gradient);
  }
  {
    const Stopwatch watch(result.timings.solve);
    ++result.counts.linear_solves;
    if (!work.system->solve(gradient, violation, step, equal_step)) return false;
  }
  if (!step.allFinite() || !equal_step.allFinite()) return false;
  if (believable_fraction(result.x, step, options.newton.longest_step) < 1) return false;
  if (options.newton.guard * work.assembly.largest_step(result.x, step) < 1) return false;
  result.x += step;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    EliminatedSlack& slack = work.slacks[k];
    slack.updated_multipliers(result.x, std::numeric_limits<double>::infinity(), result.multipliers[k]);
    slack.set_multipliers(result.multipliers[k]);
  }
  work.equalities.put(equal + equal_step, work.slacks.size(), result.multipliers);
  judged = residuals(problem, result);
  return true;
}

/// Newton steps on the optimality conditions from result.x and result.multipliers, for the rows that the projection
/// calls active there. True where they end within tolerance, in `result` and `judged`; else nothing has changed but the
/// assembly's matrix.
///
/// Of the matrix [H J^T; J -1/mu] of these conditions, with a penalty's -1/mu in the corner, the augmented Lagrangian's
/// is what is left when the multipliers are eliminated: positive definite where H is on J dx = 0, mu being large
/// enough. So nothing else is factorised, and rounds with the same factor and the residuals at the new point take away
/// the effect of 1/mu, each by a factor of about mu over the energies' stiffness [Gill and Robinson 2012].
bool AugmentedLagrangian::Run::newton_finish() {
  constexpr double near = 1e-3;  // all residuals, relative
  constexpr int most_factors = 3, most_rounds = 4;
  constexpr double worth_another = 0.3;  // of the worst residual may be left by a step
  constexpr double enough = 0.1;         // of the tolerances: where the method converges, it goes far below them
  if (!options.newton_finish || !judged.within({near, near, near})) return false;
  std::vector<Vector> kept_multipliers;
  std::vector<double> kept_penalties;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    kept_multipliers.push_back(work.slacks[k].multipliers());
    kept_penalties.push_back(work.slacks[k].penalty());
    work.slacks[k].set_penalty(std::max(start_penalty[k], work.slacks[k].penalty()));
  }
  struct Point {
    Vector x;
    std::vector<Vector> multipliers;
    Residuals judged;
  };
  const auto here = [&] { return Point{result.x, result.multipliers, judged}; };
  const auto go_to = [&](const Point& point) {
    result.x = point.x;
    result.multipliers = point.multipliers;
    judged = point.judged;
    for (std::size_t k = 0; k < work.slacks.size(); ++k) work.slacks[k].set_multipliers(result.multipliers[k]);
  };
  const auto factorize = [&] {
    {
      const Stopwatch watch(result.timings.assembly);
      work.assembly.hessian(result.x, Curvature::exact);
    }
    const Stopwatch watch(result.timings.factorization);
    ++result.counts.factorizations;
    return work.system->factorize(0);
  };

  const Point start = here();
  go_to(start);
  double before = std::numeric_limits<double>::infinity();
  for (int factor = 0; factor < most_factors && judged.over(options.tolerances) <= worth_another * before; ++factor) {
    before = judged.over(options.tolerances);
    if (!factorize()) break;
    for (int round = 0; round < most_rounds; ++round) {
      if (linear_solves() >= options.max_newton || budget.interrupted() || budget.out_of_time()) break;
      const Point last = here();
      if (newton_step() && judged.over(options.tolerances) <= worth_another * last.judged.over(options.tolerances))
        continue;
      go_to(last);
      break;
    }
    if (judged.over(options.tolerances) <= enough) return true;
  }
  go_to(start);
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    work.slacks[k].set_multipliers(kept_multipliers[k]);
    work.slacks[k].set_penalty(kept_penalties[k]);
  }
  return false;
}

}  // namespace taut
