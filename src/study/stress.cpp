#include "study/stress.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "study/compare_entry.h"
#include "study/machine.h"
#include "study/solver_entries.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

constexpr std::array<std::string_view, 6> outcome_names{"solved", "honest_failure", "false_success",
                                                        "crash",  "timeout",        "not_applicable"};

/// The last step and what it ended as.
std::string describe(const StepTrial& trial) {
  const bool lies = trial.false_success();
  std::string text = fmt::format("step {}: {}", trial.step, lies ? "says solved" : to_string(trial.judged));
  if (lies) {
    const Residuals& r = trial.residuals;
    return text + fmt::format(", residuals {:.1e} {:.1e} {:.1e}", r.stationarity, r.feasibility, r.complementarity);
  }
  return trial.result.message.empty() ? text : text + " (" + trial.result.message + ")";
}

/// Keeps of `all` what is in `wanted`, in the order of `all`; throws InputError for a word that none has.
template <class Item, class Name>
void keep(std::vector<Item>& all, const std::vector<std::string>& wanted, const Name& name) {
  if (wanted.empty()) return;
  std::erase_if(all, [&](const Item& item) { return std::count(wanted.begin(), wanted.end(), name(item)) == 0; });
}

void check_choice(const StressOptions& options, const std::vector<StressEntry>& entries) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("StressOptions: ") + what);
  };
  require(options.threads >= 1, "threads must be at least 1");
  require(options.max_seconds > 0, "max_seconds must be positive");
  require(!options.worker.empty(), "expected a worker's command, got none");
  for (const std::string& method : options.methods) solver_entry(method, "--method");
  std::string names;
  for (const StressEntry& entry : entries) names += (names.empty() ? "" : ", ") + entry.name;
  for (const std::string& wanted : options.entries) {
    if (std::none_of(entries.begin(), entries.end(), [&](const StressEntry& one) { return one.name == wanted; }))
      throw InputError("--entry: found " + wanted + ", allowed: " + names);
  }
}

struct Place {
  std::size_t map, method, value;
};

class Stress {
 public:
  explicit Stress(const StressOptions& options) : options_(options) {}

  StressAtlas go() {
    plan();
    if (options_.on_start) options_.on_start(static_cast<int>(places_.size()));
    std::vector<std::thread> threads;
    for (int k = 0; k < options_.threads; ++k) threads.emplace_back([this] { work(); });
    for (std::thread& thread : threads) thread.join();
    if (failure_) std::rethrow_exception(failure_);
    for (StressMap& map : atlas_.maps) find_false_infeasible(map);
    atlas_.interrupted = stopped();
    return std::move(atlas_);
  }

 private:
  bool stopped() const { return options_.stop && options_.stop->load(std::memory_order_relaxed); }

  void plan() {
    std::vector<StressEntry> entries = read_stress_atlas(options_.atlas);
    check_choice(options_, entries);
    keep(entries, options_.entries, [](const StressEntry& entry) { return entry.name; });
    for (StressEntry& entry : entries) {
      keep(entry.methods, options_.methods, [](const std::string& method) { return method; });
      if (options_.quick) std::erase_if(entry.values, [](const StressValue& value) { return !value.quick; });
      if (entry.values.empty() || entry.methods.empty()) continue;
      StressMap& map = atlas_.maps.emplace_back();
      map.cells.assign(entry.methods.size(), std::vector<StressCell>(entry.values.size()));
      map.entry = std::move(entry);
    }
    for (std::size_t m = 0; m < atlas_.maps.size(); ++m) {
      const StressEntry& entry = atlas_.maps[m].entry;
      for (std::size_t method = 0; method < entry.methods.size(); ++method)
        for (std::size_t value = 0; value < entry.values.size(); ++value) places_.push_back({m, method, value});
    }
    atlas_.quick = options_.quick;
    atlas_.max_seconds = options_.max_seconds;
    atlas_.version = options_.version;
    atlas_.machine = this_machine();
  }

  void work() {
    for (std::size_t k = next_++; k < places_.size() && !stopped(); k = next_++) {
      try {
        run_cell(places_[k], options_.folder / std::to_string(k));
      } catch (...) {
        const std::lock_guard lock(mutex_);
        failure_ = std::current_exception();
        next_ = places_.size();
      }
    }
  }

  void run_cell(const Place& place, const fs::path& folder) {
    StressMap& map = atlas_.maps[place.map];
    const StressEntry& entry = map.entry;
    const StressValue& value = entry.values[place.value];
    const SolverEntry& method = solver_entry(entry.methods[place.method]);
    CompareJob job;
    job.problem = fs::absolute(entry.file).string();
    // The knob comes last: it may turn what the method has set.
    for (const Overrides& some : {entry.overrides, method.overrides, value.overrides})
      job.overrides.insert(job.overrides.end(), some.begin(), some.end());
    job.untimed = true;
    job.steps = 0;
    job.seconds = options_.max_seconds;
    job.memory_bytes = memory_limit;
    job.version = options_.version;
    EntryRun run;
    run_entry(folder, job, {options_.worker, false, options_.stop}, run);
    const StressCell cell = judge_cell(run);
    fs::remove_all(folder);
    const std::lock_guard lock(mutex_);
    map.cells[place.method][place.value] = cell;
    if (options_.on_cell) options_.on_cell(entry.name + " " + value.label + " " + method.label, cell);
  }

  static constexpr std::int64_t memory_limit = std::int64_t{4} << 30;

  const StressOptions& options_;
  StressAtlas atlas_;
  std::vector<Place> places_;
  std::atomic<std::size_t> next_{0};
  std::mutex mutex_;
  std::exception_ptr failure_;
};

}  // namespace

std::string_view to_string(StressOutcome outcome) { return outcome_names[static_cast<std::size_t>(outcome)]; }

StressOutcome stress_outcome(std::string_view name) {
  const auto found = std::find(outcome_names.begin(), outcome_names.end(), name);
  if (found == outcome_names.end()) throw std::invalid_argument("not an outcome: " + std::string(name));
  return static_cast<StressOutcome>(found - outcome_names.begin());
}

StressCell judge_cell(const EntryRun& run) {
  StressCell cell;
  cell.seconds = run.seconds;
  const auto is = [&cell](StressOutcome outcome, std::string text) {
    cell.outcome = outcome;
    cell.text = std::move(text);
    return cell;
  };
  for (const StepTrial& trial : run.trials) {
    if (trial.false_success()) return is(StressOutcome::false_success, describe(trial));
  }
  if (run.outcome == "refused") {
    const bool method = run.message.find(": /solver/method: ") != run.message.npos;
    return is(method ? StressOutcome::not_applicable : StressOutcome::honest_failure, "refused: " + run.message);
  }
  if (run.outcome == "time_limit") return is(StressOutcome::timeout, "out of time");
  if (run.outcome != "finished") {
    return is(StressOutcome::crash, run.outcome + (run.message.empty() ? "" : ": " + run.message));
  }
  const bool all = !run.trials.empty() && std::all_of(run.trials.begin(), run.trials.end(), [](const StepTrial& one) {
    return one.judged == Status::solved;
  });
  if (all) return is(StressOutcome::solved, fmt::format("{} steps solved", run.trials.size()));
  if (run.trials.empty()) return is(StressOutcome::crash, "the process ended without a step");
  cell.says_infeasible = run.trials.back().judged == Status::infeasible;
  return is(StressOutcome::honest_failure, describe(run.trials.back()));
}

void find_false_infeasible(StressMap& map) {
  for (std::size_t value = 0; value < map.entry.values.size(); ++value) {
    for (std::size_t other = 0; other < map.cells.size(); ++other) {
      if (map.cells[other][value].outcome != StressOutcome::solved) continue;
      for (std::vector<StressCell>& row : map.cells) {
        StressCell& cell = row[value];
        if (!cell.says_infeasible || cell.outcome == StressOutcome::false_success) continue;
        cell.outcome = StressOutcome::false_success;
        cell.text += "; " + map.entry.methods[other] + " solves it";
      }
    }
  }
}

int frontier(const std::vector<StressCell>& row) {
  const auto end = std::find_if(row.begin(), row.end(),
                                [](const StressCell& cell) { return cell.outcome != StressOutcome::solved; });
  return static_cast<int>(end - row.begin());
}

StressAtlas stress(const StressOptions& options) { return Stress(options).go(); }

}  // namespace taut
