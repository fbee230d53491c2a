#include "study/load_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut {

Result solve_step(Stepper& stepper, Solver& solver, const Tolerances& tolerances, int halvings, const Budget& budget) {
  if (halvings == 0 || stepper.options().integrator != Integrator::quasi_static)
    return solver.solve(stepper.prepare(), stepper.state().warm, budget);
  const State start = stepper.state();
  const double smallest = std::ldexp(1.0, -halvings);
  double done = 0, part = 1;
  Counts counts;
  Timings timings;
  while (true) {
    const Problem& problem = stepper.prepare(done + part);
    Result result = solver.solve(problem, stepper.state().warm, budget);
    counts += std::exchange(result.counts, {});
    timings += std::exchange(result.timings, {});
    const bool solved = result.status == Status::solved && residuals(problem, result).within(tolerances);
    const bool whole = done + part == 1;
    const bool cut_short = !(solved && whole) && (budget.interrupted() || budget.out_of_time());
    if (cut_short) {
      stepper.restore(start);
      stepper.prepare(done + part);
      result.status = budget.interrupted() ? Status::interrupted : Status::time_limit;
    }
    if (cut_short || (solved && whole)) {
      result.counts = counts;
      result.timings = timings;
      return result;
    }
    if (solved) {
      stepper.hold(result);
      done += part;
      part = std::min(2 * part, 1 - done);
    } else if (part > smallest) {
      part /= 2;
    } else {
      result.message =
          fmt::format("the load stops at {:.6g} of the whole, a larger one is not solved ({}: {})",
                      (start.step + done) / stepper.options().steps, to_string(result.status), result.message);
      result.status = Status::limit_point;
      stepper.prepare();
      result.counts = counts;
      result.timings = timings;
      return result;
    }
  }
}

}  // namespace taut
