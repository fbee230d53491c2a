#pragma once

#include "core/residuals.h"
#include "core/solver.h"
#include "dynamics/stepper.h"

namespace taut {

/// Poses and solves the next step; a static one in parts where it is not solved as a whole: the part is halved after
/// each failure, at most `halvings` times below the whole step, and doubled after each success. The result goes with
/// stepper.problem(), and with counts and seconds of all parts.
///
/// Status limit_point where even the smallest part is not solved, with the load that was reached in the message and
/// the whole step posed. A call that is cut short leaves the stepper's state as it was.
Result solve_step(Stepper& stepper, Solver& solver, const Tolerances& tolerances, int halvings, const Budget& budget);

}  // namespace taut
