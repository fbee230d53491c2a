#pragma once

#include <memory>

#include "core/solver.h"
#include "solvers/augmented_lagrangian.h"

namespace taut {

/// Minimises over the two sides of a coupling in turn, for comparison: the alternating direction method of multipliers
/// [Glowinski and Marrocco 1975; Boyd et al. 2011, 3] on L = f + nu . (A x - b) + 1/2 sum_i mu_i (A x - b)_i^2. A round
/// minimises L over the variables that are not in LinearEqualities::following (the coarse shell, the fine ones held),
/// then over those that are, and sets nu to nu + mu (A x - b). mu_i is 0.3 of the
/// stiffness that the energies have against row i at the first step. Each half is solved by
/// AugmentedLagrangian to 0.3 of the tolerance. Rounds end where the residuals of the whole problem are within it; many
/// are needed, since a half never sees how the other will yield.
class Alternating final : public Solver {
 public:
  /// Of the halves; max_outer counts rounds.
  explicit Alternating(AugmentedLagrangianOptions options = {});
  ~Alternating() override;
  std::string name() const override { return "alternating"; }
  /// Throws std::invalid_argument where the problem has no equalities, or one that does not know its two sides.
  Result solve(const Problem& problem, const WarmStart& warm, const Budget& budget) override;

 private:
  class Half;
  struct Workspace;
  void rounds(const Problem& problem, const Budget& budget, Result& result);
  AugmentedLagrangianOptions options_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace taut
