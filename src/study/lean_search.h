#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/lean_ladder.h"
#include "study/quantity_of_interest.h"

namespace taut {

/// One model that was run.
struct LeanRung {
  Levels levels;
  std::string name, words;             ///< of its problem, and what it is: "8 x 8 cells, 5 load steps"
  std::string status = "interrupted";  ///< the judge's, or what became of the process
  std::string message;                 ///< why it is not solved
  std::optional<Answer> answer;        ///< where it is solved
  double seconds = 0;                  ///< by the clock
  std::int64_t linear_solves = 0;
  double work = 0;  ///< flops of the factorisations; 0: not known
  std::int64_t peak_memory_bytes = 0;
  std::vector<std::string> command;  ///< the words that solve the same again
  std::optional<double> estimated;   ///< error against the full scene, without the safety factor
  std::optional<double> true_error;  ///< against a run of the full scene that was known before
  std::optional<double> verified;    ///< distance from the full scene where that was run, else from the rung above
                                     ///< plus what that one lacks by the estimate
};

/// What became of an attempt to tell a difference from a residual (residual_estimate.h).
struct ResidualTrial {
  std::size_t from = 0;          ///< the model whose answer was taken, a place in LeanOutcome::rungs
  Levels levels;                 ///< of the finer model, which was not run for it
  std::string name, words;       ///< of its problem, and what it is
  std::optional<Answer> answer;  ///< of the finer model; nothing where the estimate is not to be trusted
  std::optional<double> change;  ///< its distance from the other answer
  std::string why;               ///< it is not to be trusted
  double seconds = 0;            ///< by the clock
  std::int64_t linear_solves = 0;
};

/// What became of an omission when it was tried.
struct OmissionTrial {
  std::string what;
  double change = 0;  ///< of the answer, in its unit; infinite where the problem without it was not solved
  bool left_out = false;
  std::string why;
};

enum class LeanEnd {
  verified,     ///< against the rung above
  exact,        ///< the full scene was run: errors are differences to it
  over_budget,  ///< the best found before the time was over
  interrupted,  ///< the same
  not_solved    ///< no model at all, or not the full one where it was needed
};

struct LeanOutcome {
  LeanEnd end = LeanEnd::not_solved;
  std::vector<LeanRung> rungs;  ///< in the order in which they were run
  std::vector<ResidualTrial> residual_trials;
  std::vector<OmissionTrial> omissions;
  std::optional<std::size_t> lean;    ///< the model found, a place in `rungs`
  std::optional<std::size_t> above;   ///< what it was verified against
  std::optional<std::size_t> full;    ///< the full scene, where it was run
  double allowed = 0;                 ///< error, in the unit of the quantity
  double magnitude = 0;               ///< of the finest answer
  double predicted_full_seconds = 0;  ///< from the costliest rung; measured where the full scene was run
};

/// How models are run and when to stop.
struct LeanRunner {
  /// Runs one model, whatever becomes of it; with at most so many linear solves where they are not 0.
  std::function<LeanRung(const Levels&, long max_linear_solves)> run;
  /// Tells the answer of a finer model from the residual of one that was run; empty: never.
  std::function<ResidualTrial(const LeanRung& coarse, const Levels& finer)> estimate;
  /// True once no further model may be started, and the last one may have been cut short.
  std::function<bool()> interrupted, out_of_time;
};

/// Estimates have to hold this often.
inline constexpr double lean_safety = 1.5;

/// Looks for the cheapest model whose answer is within the tolerance of the full scene's; see docs/guide/lean.md.
///
/// It starts with every refinement at its simplest, measures what one level more changes (by a residual where that
/// tells it, else by running it) and what each omission changes, and refines what its estimate is largest for until
/// lean_safety times the sum of all estimates is allowed. That model is run and compared with the one above it: every
/// refinement one level finer, nothing left out. Where that does not confirm it the search goes on from there, at worst
/// up to the full scene.
LeanOutcome lean_search(const LeanLadder& ladder, const AnswerTolerance& tolerance, const LeanRunner& runner);

}  // namespace taut
