#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "problems/read_scene.h"
#include "study/lean_search.h"
#include "study/records.h"

namespace taut {

struct LeanOptions {
  std::filesystem::path problem;
  Overrides settings;  ///< of every model
  QuantityOfInterest quantity;
  AnswerTolerance tolerance;
  double max_seconds = 0;               ///< of the whole search; 0: no limit
  std::int64_t memory_limit_bytes = 0;  ///< of each process; 0: none
  int threads = 1;
  std::filesystem::path known;       ///< a run of the full scene, to measure true errors by; empty: none
  std::filesystem::path folder;      ///< where everything is written
  std::vector<std::string> program;  ///< command that starts taut
  const std::atomic<bool>* stop = nullptr;
  std::string version;                                    ///< of the calling program
  std::function<void(const LeanRung& finished)> on_rung;  ///< after each model
  std::function<void(const ResidualTrial& finished)> on_estimate;
};

/// A question, the models that were tried, and the cheapest that answers it.
struct LeanStudy {
  std::string problem;  ///< its name
  QuantityOfInterest quantity;
  AnswerTolerance tolerance;
  LeanLadder ladder;
  LeanOutcome outcome;
  double seconds = 0;                   ///< of the whole search, by the clock
  std::optional<double> known_seconds;  ///< of the known run of the full scene
  std::string file;                     ///< of the model found, relative to the folder; empty: none
  double max_seconds = 0;
  int threads = 1;
  std::string version;
  Machine machine;

  /// Seconds of the full scene: known, measured, or predicted.
  double full_seconds() const { return known_seconds.value_or(outcome.predicted_full_seconds); }
  /// The search took longer than the full scene.
  bool costs_more_than_full() const { return seconds > full_seconds(); }
};

/// Finds the cheapest model that answers a question about a scene (lean_search()); each model is a problem file in
/// `folder`/problems and a `taut solve` in a process of its own. Writes `folder`/NAME.lean.json, which runs.
///
/// Throws InputError for a problem that cannot be used or cannot answer, RunRefused for a folder that is neither empty
/// nor of a search and for a known run of another problem or without an answer, FileError for files that cannot be
/// written.
LeanStudy lean(const LeanOptions& options);

/// Solves the scene as it is written, then once without each thing that it could do without (omissions_of()).
/// LeanOutcome::omissions says what changed the answer, `left_out` what could go. Throws as lean().
LeanStudy check_lean(const LeanOptions& options);

/// lean.json: everything.
std::string lean_text(const LeanStudy& study);

}  // namespace taut
