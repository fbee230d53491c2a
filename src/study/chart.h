#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "study/chart_plan.h"
#include "study/chart_records.h"

namespace taut {

struct ChartOptions {
  ChartChoice choice;
  FindProblem find;                     ///< of the names in `choice`
  double max_seconds = 600;             ///< wall clock of each run
  double accuracy = 0.01;               ///< error up to which a solved run counts as correct
  std::int64_t memory_limit_bytes = 0;  ///< of each process; 0: none
  int threads = 1;
  bool resume = false;               ///< take over the finished runs of the chart in `folder`
  std::filesystem::path folder;      ///< where everything is written
  std::vector<std::string> program;  ///< command that starts taut
  const std::atomic<bool>* stop = nullptr;
  std::string version;                                      ///< of the calling program
  std::function<void(int tasks)> on_start;                  ///< before the first run
  std::function<void(const ChartPoint& finished)> on_task;  ///< after each run, and once for all of a reference
};

/// Runs every solver at every value of the knob, each in a process of its own (`taut solve`), and measures the errors
/// against a closed form or against a solution by another method, whose own error is estimated.
///
/// Whatever becomes of a process (a crash, too much time or memory) is recorded and ends nothing else. `stop` ends the
/// chart with what is finished.
///
/// Throws InputError for problems and choices that do not fit, RunRefused for a folder that is neither empty nor a
/// chart's, FileError for files that cannot be written, std::invalid_argument for options that make no sense.
ChartData chart(const ChartOptions& options);

}  // namespace taut
