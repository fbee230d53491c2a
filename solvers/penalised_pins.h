#pragma once

#include <memory>

#include "core/solver.h"

namespace taut {

/// Poses fixed variables as rows x_i - value_i = 0 and leaves them to another solver's penalties and multipliers, where
/// that solver would substitute them: what codes without substitution do. The pins then hold to the tolerance and not
/// to the last bit. The result is judged as one of the original problem.
class PenalisedPins final : public Solver {
 public:
  explicit PenalisedPins(std::unique_ptr<Solver> inner, Tolerances tolerances);
  ~PenalisedPins() override;
  std::string name() const override { return inner_->name(); }
  Result solve(const Problem& problem, const WarmStart& warm, const Budget& budget) override;

 private:
  class Rows;
  std::unique_ptr<Solver> inner_;
  Tolerances tolerances_;
  std::unique_ptr<Rows> rows_;
  std::uint64_t topology_ = 0, own_topology_ = 0;  ///< of the problem that rows_ belong to, and of the one with rows
};

}  // namespace taut
