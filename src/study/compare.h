#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "study/compare_plan.h"
#include "study/compare_records.h"

namespace taut {

struct CompareOptions {
  std::vector<std::filesystem::path> problems;
  EntryChoice choice;
  int steps = 0;   ///< of each problem at most; 0: all
  int repeat = 1;  ///< timed solves of each step
  int threads = 1;
  bool free = false;    ///< each entry follows its own trajectory, instead of starting each step from the reference's
  bool cold = false;    ///< no multipliers and penalties from the states
  bool resume = false;  ///< take over the finished processes of the comparison in `folder`
  double time_limit = 600;              ///< s, wall clock of each process; 0: none
  std::int64_t memory_limit_bytes = 0;  ///< of each process; 0: none
  std::filesystem::path folder;         ///< where everything is written
  std::vector<std::string> worker;      ///< command that carries out a job whose file is appended to it
  const std::atomic<bool>* stop = nullptr;
  std::string version;                                   ///< of the calling program
  std::function<void(int processes)> on_start;           ///< before the first process
  std::function<void(const EntryRun& finished)> on_run;  ///< after each process, trajectories included
};

/// Compares solvers, each in a process of its own with a limit on time and memory, on the steps of some problems.
///
/// First the reference solves the steps of the problem; the states before them are what every entry starts from. A
/// reference that does not solve a step ends there, and that step is the last of the comparison. Whatever becomes of a
/// process (a crash, too much time or memory) is recorded and ends nothing else. `stop` ends the comparison with what
/// is finished.
///
/// Throws InputError for problems and choices that do not fit, RunRefused for a folder that is neither empty nor a
/// comparison's, FileError for files that cannot be written, std::invalid_argument for options that make no sense.
Comparison compare(const CompareOptions& options);

}  // namespace taut
