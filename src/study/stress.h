#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "study/compare_records.h"
#include "study/stress_atlas.h"

namespace taut {

/// What became of a method at a place of the atlas. `solved`: every step is within tolerance. `honest_failure`: a
/// status with a name, or an input that is refused. `false_success`: the method says solved and the residuals do not,
/// or it says infeasible and another method solves the same problem. `crash`: the process was ended by a signal, by an
/// exception or for its memory. `not_applicable`: the method is refused, not the problem.
enum class StressOutcome { solved, honest_failure, false_success, crash, timeout, not_applicable };
std::string_view to_string(StressOutcome outcome);
/// The outcome of that name; throws std::invalid_argument for any other word.
StressOutcome stress_outcome(std::string_view name);

struct StressCell {
  StressOutcome outcome = StressOutcome::not_applicable;
  std::string text;  ///< one line: which step, which status, the solver's message
  bool says_infeasible = false;
  double seconds = 0;  ///< wall clock of the process
};

/// Judges what a process has left of a cell, without a look at other methods.
StressCell judge_cell(const EntryRun& run);

struct StressMap {
  StressEntry entry;                           ///< with the methods and values that were run
  std::vector<std::vector<StressCell>> cells;  ///< [method][value]
};

/// Turns `infeasible` into a false success where another method has solved the same value.
void find_false_infeasible(StressMap& map);

/// How many values from the easy end a method solves without a gap.
int frontier(const std::vector<StressCell>& row);

struct StressOptions {
  std::filesystem::path atlas;
  std::vector<std::string> methods;  ///< none: those of the atlas
  std::vector<std::string> entries;  ///< none: all
  bool quick = false;
  int threads = 1;                  ///< cells at a time, each in a process of one thread
  double max_seconds = 20;          ///< wall clock of a cell
  std::filesystem::path folder;     ///< for what the processes leave; may be removed afterwards
  std::vector<std::string> worker;  ///< command that carries out a job whose file is appended to it
  const std::atomic<bool>* stop = nullptr;
  std::string version;
  std::function<void(int cells)> on_start;
  std::function<void(const std::string& name, const StressCell& cell)> on_cell;  ///< one at a time
};

struct StressAtlas {
  std::vector<StressMap> maps;
  bool quick = false, interrupted = false;
  double max_seconds = 0;  ///< of a cell
  std::string version;
  Machine machine;
};

/// Runs every cell of an atlas in a process of its own and judges it. Throws InputError for an atlas, methods or
/// entries that do not fit, FileError, std::invalid_argument for options that make no sense.
StressAtlas stress(const StressOptions& options);

}  // namespace taut
