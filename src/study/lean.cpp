#include "study/lean.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "files/atomic_file.h"
#include "study/chart_run.h"
#include "study/machine.h"
#include "study/residual_estimate.h"
#include "study/run_folder.h"
#include "study/stored_run.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

constexpr const char* lean_file = "lean.json";
constexpr const char* problems_folder = "problems";
constexpr const char* runs_folder = "runs";
constexpr double unlimited_seconds = 1e6;
constexpr std::int64_t growth_of_memory = 8;  // at most, by one mesh level: four times the vertices, and fill

/// Throws RunRefused for a folder that is neither missing, nor empty, nor a search's; removes an earlier search.
void begin(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error)) {
    if (!fs::is_directory(folder, error)) throw RunRefused(folder.string() + ": is not a directory");
    if (!fs::is_empty(folder, error) && !fs::exists(folder / lean_file, error)) {
      throw RunRefused(
          folder.string() +
          ": is not empty and holds no search of taut lean; nothing was touched, choose another directory");
    }
  }
  for (const char* earlier : {problems_folder, runs_folder}) fs::remove_all(folder / earlier, error);
  fs::create_directories(folder / problems_folder, error);
  if (error) throw RunRefused(folder.string() + ": cannot be created: " + error.message());
}

Scene read_full(const LeanOptions& options) {
  Scene scene = read_scene(options.problem, options.settings);
  check_quantity(options.quantity, scene);
  const bool frequency = options.quantity.kind == QuantityOfInterest::Kind::frequency;
  if (!frequency || scene.time.frequencies >= options.quantity.mode) return scene;
  Overrides settings = options.settings;
  settings.emplace_back("time.frequencies", std::to_string(options.quantity.mode));
  return read_scene(options.problem, settings);
}

/// Runs models one after another and keeps the time.
class Runner {
 public:
  Runner(const LeanOptions& options, const Scene& full, const LeanLadder& ladder)
      : options_(options), full_(full), ladder_(ladder), observer_(options.quantity, full), start_(Clock::now()) {}

  LeanRung run(const Levels& levels, long max_linear_solves = 0);
  ResidualTrial estimate(const LeanRung& coarse, const Levels& finer);
  const Observer& observer() const { return observer_; }
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool interrupted() const { return options_.stop && options_.stop->load(std::memory_order_relaxed); }
  bool out_of_time() const { return options_.max_seconds > 0 && seconds() >= options_.max_seconds; }
  LeanRunner callbacks() {
    return {.run = [this](const Levels& levels, long max_linear_solves) { return run(levels, max_linear_solves); },
            .estimate = [this](const LeanRung& coarse, const Levels& finer) { return estimate(coarse, finer); },
            .interrupted = [this] { return interrupted(); },
            .out_of_time = [this] { return out_of_time(); }};
  }

 private:
  using Clock = std::chrono::steady_clock;
  void solve(const fs::path& file, long max_linear_solves, LeanRung& rung) const;

  const LeanOptions& options_;
  const Scene& full_;
  const LeanLadder& ladder_;
  Observer observer_;
  Clock::time_point start_;
  int runs_ = 0, estimates_ = 0;
};

void Runner::solve(const fs::path& file, long max_linear_solves, LeanRung& rung) const {
  const double left = options_.max_seconds > 0 ? std::max(0.1, options_.max_seconds - seconds()) : unlimited_seconds;
  const ChartProcess process{.program = options_.program,
                             .folder = options_.folder,
                             .threads = options_.threads,
                             .max_seconds = left,
                             .memory_limit_bytes = options_.memory_limit_bytes,
                             .resume = false,
                             .stop = options_.stop,
                             .version = options_.version};
  ChartPoint point;
  point.folder = std::string(runs_folder) + "/" + rung.name;
  const Clock::time_point begin = Clock::now();
  run_point(process,
            {.problem = file.string(), .overrides = {}, .history_step = 0, .max_linear_solves = max_linear_solves},
            point);
  rung.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  rung.status = point.status;
  rung.message = point.message;
  rung.linear_solves = point.counts.linear_solves;
  rung.work = point.counts.factor_flops;
  rung.peak_memory_bytes = point.peak_memory_bytes;
  rung.command = point.command;
  if (!point.solved()) return;
  rung.answer = observer_(read_stored_run(run_folder(process, point)));
  if (!rung.answer) {
    rung.status = "no answer";
    rung.message = "the quantity is not there, or not a number";
  }
}

LeanRung Runner::run(const Levels& levels, long max_linear_solves) {
  LeanRung rung;
  rung.levels = levels;
  rung.words = words_of(ladder_, levels);
  rung.name = fmt::format("{}_{:02}", full_.name, ++runs_);
  const fs::path file = options_.folder / problems_folder / (rung.name + ".json");
  try {
    write_rung(full_, ladder_, levels, rung.name, file);
    solve(file, max_linear_solves, rung);
  } catch (const InputError& error) {
    rung.status = "cannot be built";
    rung.message = error.what();
  }
  if (options_.on_rung) options_.on_rung(rung);
  return rung;
}

/// In this process: it takes one factorisation.
ResidualTrial Runner::estimate(const LeanRung& coarse, const Levels& finer) {
  ResidualTrial trial;
  trial.name = fmt::format("{}_residual_{:02}", full_.name, ++estimates_);
  trial.levels = finer;
  trial.words = words_of(ladder_, finer);
  const std::int64_t limit = options_.memory_limit_bytes;
  if (limit > 0 && growth_of_memory * coarse.peak_memory_bytes > limit) {
    trial.why = "it might need more memory than a model may";
    return trial;
  }
  const fs::path file = options_.folder / problems_folder / (trial.name + ".json");
  try {
    write_rung(full_, ladder_, finer, trial.name, file);
    const StoredRun run = read_stored_run(options_.folder / runs_folder / coarse.name / "run");
    ResidualEstimate found = residual_estimate(run, read_scene(file), observer_, options_.threads);
    trial.answer = std::move(found.answer);
    trial.why = std::move(found.why);
    trial.seconds = found.seconds;
    trial.linear_solves = found.linear_solves;
  } catch (const InputError& error) {
    trial.why = error.what();
  }
  if (options_.on_estimate) options_.on_estimate(trial);
  return trial;
}

LeanStudy new_study(const LeanOptions& options, const Scene& full, LeanLadder ladder) {
  LeanStudy study;
  study.problem = full.name;
  study.quantity = options.quantity;
  study.tolerance = options.tolerance;
  study.ladder = std::move(ladder);
  study.max_seconds = options.max_seconds;
  study.threads = options.threads;
  study.version = options.version;
  study.machine = this_machine();
  return study;
}

/// Adds the errors against a run of the full scene that was there before the search.
void measure_true_errors(const LeanOptions& options, const Scene& full, const Observer& observer, LeanStudy& study) {
  if (options.known.empty()) return;
  const StoredRun run = read_stored_run(options.known);
  if (run.scene.hash != full.hash) throw RunRefused(options.known.string() + ": is a run of another problem");
  const std::optional<Answer> answer = observer(run);
  if (!answer || run.summary.status != Status::solved)
    throw RunRefused(options.known.string() + ": has no answer to " + options.quantity.text());
  study.known_seconds = run.summary.seconds.total;
  study.outcome.magnitude = answer->magnitude;
  for (LeanRung& rung : study.outcome.rungs)
    if (rung.answer) rung.true_error = distance(*rung.answer, *answer);
}

void finish(const LeanOptions& options, LeanStudy& study) {
  write_atomically(options.folder / lean_file, lean_text(study));
}

}  // namespace

LeanStudy lean(const LeanOptions& options) {
  const Scene full = read_full(options);
  LeanStudy study = new_study(options, full, lean_ladder(full));
  Runner runner(options, full, study.ladder);
  begin(options.folder);
  study.outcome = lean_search(study.ladder, options.tolerance, runner.callbacks());
  study.seconds = runner.seconds();
  measure_true_errors(options, full, runner.observer(), study);
  if (study.outcome.lean) {
    study.file = full.name + ".lean.json";
    write_rung(full, study.ladder, study.outcome.rungs[*study.outcome.lean].levels, full.name + "_lean",
               options.folder / study.file);
  }
  finish(options, study);
  return study;
}

LeanStudy check_lean(const LeanOptions& options) {
  const Scene full = read_full(options);
  LeanStudy study = new_study(options, full, omissions_of(full));
  Runner runner(options, full, study.ladder);
  begin(options.folder);
  LeanOutcome& outcome = study.outcome;
  const std::size_t number = study.ladder.simplifications.size();
  outcome.rungs.push_back(runner.run(Levels(number, 0)));
  if (!runner.interrupted() && outcome.rungs[0].answer) {
    outcome.full = 0;
    outcome.end = LeanEnd::exact;
    outcome.predicted_full_seconds = outcome.rungs[0].seconds;
    outcome.magnitude = outcome.rungs[0].answer->magnitude;
    outcome.allowed = options.tolerance.allowed(outcome.magnitude);
  }
  for (std::size_t k = 0; k < number && outcome.full; ++k) {
    const Simplification& omission = study.ladder.simplifications[k];
    for (int level = omission.simplest(); level > 0; --level) {
      if (runner.interrupted() || runner.out_of_time()) {
        outcome.end = runner.interrupted() ? LeanEnd::interrupted : LeanEnd::over_budget;
        k = number - 1;
        break;
      }
      Levels levels(number, 0);
      levels[k] = level;
      LeanRung& rung = outcome.rungs.emplace_back(runner.run(levels));
      OmissionTrial trial{.what = omission.levels[static_cast<std::size_t>(level)],
                          .change = rung.answer ? distance(*rung.answer, *outcome.rungs[0].answer)
                                                : std::numeric_limits<double>::infinity(),
                          .left_out = false,
                          .why = rung.answer ? "" : rung.status + ": " + rung.message};
      rung.verified = trial.change;
      trial.left_out = trial.change <= outcome.allowed;
      outcome.omissions.push_back(trial);
      if (trial.left_out) break;
    }
  }
  if (runner.interrupted()) outcome.end = LeanEnd::interrupted;
  study.seconds = runner.seconds();
  finish(options, study);
  return study;
}

}  // namespace taut
