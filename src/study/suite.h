#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/compare_plan.h"
#include "study/profiles.h"
#include "study/records.h"

namespace taut {

struct SuiteModel {
  std::string name, file;
  std::optional<double> reference;  ///< best value known of the objective
};

/// What one entry made of one model, in a process of its own.
struct SuiteRun {
  std::string outcome = "interrupted";  ///< as EntryRun::outcome; the rest is of finished ones
  std::string message;                  ///< why it is not finished or not solved
  Status status = Status::stalled;      ///< by the judge
  bool false_success = false;           ///< ModelSolution::false_success
  bool maximise = false;
  double objective = 0;     ///< as the model has it
  double violation = 0;     ///< largest of any row or bound as written
  double stationarity = 0;  ///< relative, as judged
  double seconds = 0;       ///< of the solver, median over the repeats
  Counts counts;

  bool solved() const { return outcome == "finished" && status == Status::solved; }
};

struct SuiteEntry {
  ChosenEntry chosen;
  std::vector<SuiteRun> runs;  ///< by model
};

/// Solvers on a folder of models.
struct Suite {
  std::string folder;
  std::vector<SuiteModel> models;
  std::vector<SuiteEntry> entries;
  int repeat = 1;
  double time_limit = 0;  ///< s, of each process
  bool interrupted = false;
  std::string version;
  Machine machine;
};

struct SuiteOptions {
  std::filesystem::path folder;
  EntryChoice choice;
  int repeat = 1;
  double time_limit = 60;               ///< s, wall clock of each process; 0: none
  std::int64_t memory_limit_bytes = 0;  ///< of each process; 0: none
  std::vector<std::string> worker;      ///< command to which try_model()'s arguments are appended
  std::filesystem::path logs;           ///< folder for what the processes print
  const std::atomic<bool>* stop = nullptr;
  std::string version;
  std::function<void(int processes)> on_start;
  std::function<void(const SuiteModel&, const SuiteEntry&, const SuiteRun&)> on_run;
};

/// Runs every entry on every .nl file of the folder, one process at a time. Best known values come from its
/// reference.csv, from the columns `name` and `f` (or `best_known_f`). Throws InputError for a folder without models, a
/// CSV without these columns, and choices that do not fit.
Suite run_suite(const SuiteOptions& options);

/// What a worker does with its model: solves it `repeat` times and prints the run as a line on standard output.
/// `max_seconds` 0: no limit. Throws InputError.
void try_model(const std::string& file, const Overrides& overrides, int repeat, double max_seconds);

/// |f - best known| <= 1e-5 max(1, |best known|) and no violation above 1e-6, whatever the status, or better than the
/// best known value; where no value is known, solved.
bool is_correct(const SuiteModel& model, const SuiteRun& run);
/// By more than 1e-5 max(1, |best known|), at a point that violates nothing at all: without a constraint qualification
/// a violation of 1e-12 can buy that much (hs013).
bool is_better_than_known(const SuiteModel& model, const SuiteRun& run);

struct SuiteScore {
  int false_successes = 0, correct = 0, solved = 0;  ///< models
  double median_seconds = 0;                         ///< of the finished runs, NaN for none
  double mean_seconds = 0;   ///< shifted geometric mean; what is not correct counts Suite::time_limit
  double linear_solves = 0;  ///< median of the finished runs
};
/// Seconds that are added before the mean is taken.
inline constexpr double suite_mean_shift = 1e-3;
SuiteScore score_of(const Suite& suite, const SuiteEntry& entry);

/// By entry, of the correct runs; cost: the solver's seconds.
std::vector<Profile> performance_of(const Suite& suite);

/// The text of compare.json.
std::string suite_text(const Suite& suite);

}  // namespace taut
