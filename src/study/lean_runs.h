#pragma once

#include <cstddef>
#include <optional>

#include "study/lean_costs.h"
#include "study/lean_search.h"

namespace taut {

/// No further model may be started.
struct LeanHalt {};

/// The models of a search that were run, each once, and what they say about one another.
class LeanRuns {
 public:
  /// Everything is borrowed; models go to outcome.rungs.
  LeanRuns(const LeanLadder& ladder, const AnswerTolerance& tolerance, const LeanRunner& runner, LeanOutcome& outcome)
      : ladder_(ladder), tolerance_(tolerance), runner_(runner), outcome_(outcome), costs_(ladder) {}

  /// The place of a model in outcome.rungs, where it is put if it was not run before: with at most so many linear
  /// solves, or as many as it is worth (LeanCosts::allowed_solves) where that is 0. Throws LeanHalt.
  std::size_t run(const Levels& levels, long max_solves = 0);
  bool was_run(const Levels& levels) const { return find(levels).has_value(); }
  /// How far the finer model is from one that was run, by its residual, and notes the attempt; nothing where that
  /// cannot be trusted. Throws LeanHalt.
  std::optional<double> change_by_residual(std::size_t coarse, const Levels& finer);

  LeanRung& operator[](std::size_t place) { return outcome_.rungs[place]; }
  /// How far two answers are apart; infinite where one is missing.
  double between(std::size_t a, std::size_t b);
  /// The error that is allowed, by the magnitude of the finest answer so far.
  double allowed();
  const LeanCosts& costs() const { return costs_; }

 private:
  std::optional<std::size_t> find(const Levels& levels) const;
  int coarseness(const Levels& levels) const;

  const LeanLadder& ladder_;
  const AnswerTolerance& tolerance_;
  const LeanRunner& runner_;
  LeanOutcome& outcome_;
  LeanCosts costs_;
};

}  // namespace taut
