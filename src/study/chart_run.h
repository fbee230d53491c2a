#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "problems/read_scene.h"
#include "study/chart_records.h"

namespace taut {

/// How the runs of a chart are started.
struct ChartProcess {
  std::vector<std::string> program;  ///< starts taut; its arguments are appended
  std::filesystem::path folder;      ///< of the chart
  int threads = 1;
  double max_seconds = 0;
  std::int64_t memory_limit_bytes = 0;  ///< 0: none
  bool resume = false;                  ///< take over finished runs of the same command and version
  const std::atomic<bool>* stop = nullptr;
  std::string version;
};

/// What a run solves.
struct ChartJob {
  std::string problem;  ///< as `taut solve` takes it
  Overrides overrides;
  int history_step = 0;        ///< 0: no history
  long max_linear_solves = 0;  ///< 0: no limit
};

/// `taut solve` with these words gives the same run.
std::vector<std::string> solve_words(const ChartJob& job, const ChartProcess& process);

/// Lets `taut solve` run the job in a process of its own, in point.folder, and takes what it has left into the point:
/// outcome, status, counts, seconds, memory, probes. Whatever becomes of the process, this returns. A run that was
/// interrupted is not finished and is not taken over. Throws FileError.
void run_point(const ChartProcess& process, const ChartJob& job, ChartPoint& point);

/// The folder that `taut solve --out` has written for a point.
std::filesystem::path run_folder(const ChartProcess& process, const ChartPoint& point);

}  // namespace taut
