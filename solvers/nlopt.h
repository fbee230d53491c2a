#pragma once

#include <memory>
#include <string_view>

#include "core/solver.h"

namespace taut {

/// Algorithms of NLopt that take gradients and constraints: sequential quadratic programming [Kraft 1994], or NLopt's
/// augmented Lagrangian [Birgin and Martinez 2008] over a minimiser without constraints.
enum class NloptAlgorithm { slsqp, auglag_slsqp, auglag_lbfgs, auglag_ccsaq, auglag_tnewton };
std::string_view to_string(NloptAlgorithm algorithm);
/// The most free variables that the algorithm is let loose on: beyond, a step takes minutes (docs/guide/solvers.md has
/// the measurement).
int largest_nlopt_problem(NloptAlgorithm algorithm);

struct NloptOptions {
  Tolerances tolerances;
  NloptAlgorithm algorithm = NloptAlgorithm::slsqp;
  int max_evaluations = 20000;  ///< values of the objective in one solve
  void validate() const;
};

/// NLopt on the smooth scalar form of the problem (nonlinear_program.h), with dense Jacobians and no second
/// derivatives.
///
/// NLopt sees the variables z of y = y0 + D z and the objective (f - f0)/S, with D^2 = S/diag(f'') and S = max_i
/// (f'_i)^2/f''_ii at the start: the Hessian has a unit diagonal and the largest slope is 1. Rows of the constraints
/// are divided by the norm of their gradient in z there.
///
/// Where the result is not solved, NLopt starts again there, scaled anew, as long as that halves the worst residual.
///
/// It returns no multipliers: they are recovered as the least-squares solution of f' + J^T nu = 0 on the rows that are
/// nearly active, with their signs. Its return codes decide nothing, since it calls a NaN a success and good points
/// failures: `solved` is said by residuals(), and what is not solved is `stalled` unless a limit was hit. It does not
/// recognise infeasible problems.
///
/// Counts: function_evaluations only.
class Nlopt final : public Solver {
 public:
  explicit Nlopt(NloptOptions options = {});
  std::string name() const override { return "nlopt"; }
  /// Throws std::invalid_argument where the problem has more free variables than largest_nlopt_problem().
  Result solve(const Problem& problem, const WarmStart& warm, const Budget& budget) override;

 private:
  NloptOptions options_;
};

}  // namespace taut
