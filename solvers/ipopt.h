#pragma once

#include <memory>

#include "core/solver.h"

namespace taut {

struct IpoptOptions {
  Tolerances tolerances;
  int max_iterations = 500;  ///< of one of the two attempts, those of its restoration phase included
  /// Starts at the multipliers of the step before where there are any, with a small barrier. Measured: fewer iterations
  /// where few constraints change from step to step, many more where many do.
  bool warm_start = false;
  double warm_barrier = 1e-6;  ///< the barrier parameter then, with the objective scaled to forces of order one
  void validate() const;
};

/// Ipopt, an interior-point method with a filter line search [Waechter and Biegler 2006], on the smooth scalar form of
/// the problem (nonlinear_program.h) with exact gradient, Jacobian and Hessian. The objective is divided by the start's
/// largest nodal force. Ipopt is asked for more than the tolerances, because its own errors are scaled differently;
/// what it says of itself decides nothing: `solved` is said by residuals().
///
/// What it leaves unsolved (stalled, iteration_limit) is tried again from the same start with another guard of the
/// barrier; the better of the two ends is returned.
///
/// Its multipliers are positive everywhere, those of inactive rows tiny. They are returned as they are, or projected
/// to the normal cones, whichever the residuals like better.
///
/// Ipopt 3.11 is not thread-safe: one solve at a time runs in a process, others wait.
///
/// Counts: `outer` and `linear_solves` are Ipopt's iterations, `factorizations` its Hessians (each is factorised once,
/// or more often where its inertia is wrong, which Ipopt does not tell).
class Ipopt final : public Solver {
 public:
  explicit Ipopt(IpoptOptions options = {});
  ~Ipopt() override;
  std::string name() const override { return "ipopt"; }
  Result solve(const Problem& problem, const WarmStart& warm, const Budget& budget) override;

 private:
  struct Workspace;
  void run(const Problem& problem, const WarmStart& warm, const Budget& budget, Result& result);

  IpoptOptions options_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace taut
