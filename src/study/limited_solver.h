#pragma once

#include <string>

#include "core/solver.h"

namespace taut {

/// A solver that has so many linear solves for all its calls together, which unlike seconds are the same on every
/// machine. The call that uses them up ends with the status iteration_limit within one iteration, and so does every
/// later one. Solvers that show no iterates to their observer (NLopt) are stopped between calls only.
class LimitedSolver final : public Solver {
 public:
  /// `solver` is borrowed, and its observer taken for the time of each call.
  LimitedSolver(Solver& solver, long linear_solves) : solver_(solver), allowed_(linear_solves) {}
  std::string name() const override { return solver_.name(); }
  Result solve(const Problem& problem, const WarmStart& warm, const Budget& budget) override;
  bool used_up() const { return used_ >= allowed_; }
  /// Says that they are used up.
  std::string message() const;

 private:
  Solver& solver_;
  long allowed_, used_ = 0;
};

}  // namespace taut
