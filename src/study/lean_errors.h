#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "study/convergence.h"
#include "study/lean_ladder.h"

namespace taut {

/// Estimated errors of the models of a ladder: the sum of what each refinement lacks (Convergence) and of what all
/// omissions change, raised where measured differences have exceeded it.
class LeanErrors {
 public:
  explicit LeanErrors(const LeanLadder& ladder) : ladder_(ladder), convergence_(ladder.simplifications.size()) {}

  /// What one level more of a refinement changes.
  void add_difference(std::size_t k, int level, double difference) { convergence_[k].add(level, difference); }
  bool knows(std::size_t k, int level) const { return convergence_[k].knows(level); }
  /// The same, 0 where it is not known.
  double difference(std::size_t k, int level) const { return knows(k, level) ? convergence_[k].difference(level) : 0; }
  /// What the omissions of a model change, whatever its refinements.
  void add_omissions(const Levels& levels, double change) { changes_[omissions_in(levels)] = change; }
  /// A difference that was estimated was measured.
  void compare(double estimated, double measured);

  /// Of a level of a refinement alone, as it converges.
  double of_refinement(std::size_t k, int level) const { return convergence_[k].error(level); }
  /// What omissions change; infinite where that was not measured.
  double of_omissions(const Levels& levels) const;
  double estimate(const Levels& levels) const;
  /// The least that is to be expected of a level of a refinement alone.
  double least_estimate(std::size_t k, int level) const { return pessimism_ * convergence_[k].least_error(level); }
  double pessimism() const { return pessimism_; }

 private:
  Levels omissions_in(const Levels& levels) const;

  const LeanLadder& ladder_;
  std::vector<Convergence> convergence_;  // of each simplification that refines
  std::map<Levels, double> changes_;      // of the answer, by what is left out
  double pessimism_ = 1;
};

}  // namespace taut
