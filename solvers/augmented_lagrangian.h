#pragma once

#include <memory>

#include "core/solver.h"
#include "solvers/central_path.h"
#include "solvers/newton.h"

namespace taut {

/// How linear equalities enter the Newton systems (equality_system.h).
enum class EqualityForm { quasi_definite, penalised };

struct AugmentedLagrangianOptions {
  Tolerances tolerances;
  double penalty = 1000;      ///< start, as a multiple of the stiffness of the energies seen by the constraint's rows
  double penalty_growth = 8;  ///< factor where a violation does not fall fast enough
  double max_penalty_growth = 1e6;      ///< most that the start may grow in one solve
  double wanted_decrease = 0.5;         ///< of a constraint's violation from one multiplier update to the next
  double inner_tolerance_factor = 0.5;  ///< theta: inner residual over the force that the next update would change
  int max_outer = 100;                  ///< multiplier updates
  int max_newton = 1000;                ///< linear solves in all
  int threads = 1;
  EqualityForm equalities = EqualityForm::quasi_definite;
  /// How pins and linear equalities are kept: substituted and as rows with multipliers; or in the null space of their
  /// equations (null_space_system.h), as a check of the former.
  bool null_space = false;
  bool conjugate_gradients = false;  ///< in the null space: without a matrix of its own, where its factor fills in
  double fixed_penalty = 0;      ///< positive: every constraint's penalty, which then never grows and is no multiple
  bool warm_multipliers = true;  ///< start at the multipliers of the step before
  /// An inactive constraint is left out of a solve where no element is nearer to its boundary than this times the
  /// largest change of any element in the last; 0: never.
  double screening = 4;
  CentralPathOptions central_path;  ///< tried first; the loop of multiplier updates takes over where it fails
  NewtonOptions newton;
  bool newton_finish = false;  ///< Newton steps on the optimality conditions near the solution (newton_finish.cpp)
  void validate() const;
};

/// The augmented Lagrangian with slacks eliminated by projection (eliminated_slack.h), minimised by a semismooth Newton
/// method, with multipliers carried from step to step. Pattern, order and symbolic factor are kept while
/// Problem::topology stays the same.
///
/// Statuses: solved (by the residuals); infeasible (penalty grown without the violation following, and the closest
/// compromise is stationary for the violation); stalled, iteration_limit, time_limit, not_finite, interrupted, each
/// with the best point seen.
class AugmentedLagrangian final : public Solver {
 public:
  explicit AugmentedLagrangian(AugmentedLagrangianOptions options = {});
  ~AugmentedLagrangian() override;
  std::string name() const override { return options_.null_space ? "null_space" : "augmented_lagrangian"; }
  Result solve(const Problem& problem, const WarmStart& warm, const Budget& budget) override;

  /// Of the factor, the assembly's bytes included; zero before the first solve.
  NewtonSystem::Size size() const;

 private:
  struct Workspace;
  struct Run;
  AugmentedLagrangianOptions options_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace taut
