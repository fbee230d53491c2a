#pragma once

#include <cstddef>
#include <vector>

#include "study/lean_ladder.h"
#include "study/lean_search.h"

namespace taut {

/// What the models of a ladder cost, from those that were run. In work, not in seconds, so that a search goes the same
/// way on a busy machine.
class LeanCosts {
 public:
  explicit LeanCosts(const LeanLadder& ladder);

  /// What one level costs: learnt from the last of the models before that is coarser or as fine in every refinement.
  void learn(const std::vector<LeanRung>& before, const LeanRung& now);
  /// Cost of a level over that of the next simpler one.
  double ratio(std::size_t k) const { return ratio_[k]; }
  /// How many times cheaper than the full scene a model should be, omissions aside.
  double saving(const Levels& levels) const;
  /// Not only a little cheaper: else the full scene itself is the better choice.
  bool is_worth_running(const Levels& levels) const { return saving(levels) >= least_saving; }
  /// The first level of a refinement that is, alone.
  int worthwhile_level(std::size_t k) const;
  /// Linear solves with which a model would cost as much as is not worth running; 0: no limit.
  long allowed_solves(const Levels& levels) const;
  /// Seconds of the full scene by those of another model, before anything is learnt.
  double full_seconds(const LeanRung& rung) const;

 private:
  static constexpr double least_saving = 2;

  const LeanLadder& ladder_;
  std::vector<double> ratio_;
};

}  // namespace taut
