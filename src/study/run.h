#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

#include "core/solver.h"
#include "problems/scene.h"
#include "study/records.h"
#include "study/run_folder.h"

namespace taut {

/// How to run a scene. Nothing here changes the result, but for `threads` in the last bits.
struct RunOptions {
  std::filesystem::path folder;  ///< empty: nothing is written
  bool resume = false;           ///< go on with the run in `folder`; from the beginning where that is empty or missing
  std::filesystem::path accelerations;      ///< file for the spectral accelerations of a modal body; empty: none
  int threads = 0;                          ///< 0: those of the run that is resumed, or else the cores of the machine
  double max_seconds = 0;                   ///< wall clock of this call; 0: no limit
  long max_linear_solves = 0;               ///< of this call: then a step ends with iteration_limit; 0: no limit
  int history_step = 0;                     ///< the step whose iterates are judged and written; 0: none
  int export_step = 0;                      ///< the step that is written as a model to `export_file`; 0: none
  std::filesystem::path export_file;        ///< .nl
  const std::atomic<bool>* stop = nullptr;  ///< raised to interrupt the run within one linear solve
  Solver* solver = nullptr;                 ///< borrowed; null: the one that the scene names
  std::string version;                      ///< of the calling program, for the summary
  std::function<void(int steps_done)> on_start;    ///< before the first step
  std::function<void(const StepRecord&)> on_step;  ///< after every finished step
};

/// Steps a scene to its end, or until a step fails, the time is over or someone stops it. Every step is judged by
/// core/residuals.h, whatever the solver says: only what is within tolerance is `solved`.
///
/// A step that is not solved is recorded like any other; solver.on_failure says whether the run goes on. A step that is
/// cut short by the clock or `stop` is not: it belongs to no result, and a resumed run does it again. Checkpoints are
/// written at least every two seconds and at the end.
///
/// Throws InputError for a scene that cannot be built, RunRefused for a folder that does not fit, FileError for files
/// that cannot be written, std::invalid_argument for options that make no sense.
RunSummary run(const Scene& scene, const RunOptions& options);

}  // namespace taut
