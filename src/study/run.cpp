#include "study/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "core/stopwatch.h"
#include "problems/build.h"
#include "study/acceleration_record.h"
#include "study/examine.h"
#include "study/export_step.h"
#include "study/frame_output.h"
#include "study/limited_solver.h"
#include "study/load_step.h"
#include "study/machine.h"

namespace taut {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr int worst_elements_kept = 5;
constexpr Seconds longest_without_checkpoint{2};
constexpr double checkpoint_share = 0.05;  // of the time, where steps are shorter than that

void check(const RunOptions& options) {
  if (!(options.max_seconds >= 0)) throw std::invalid_argument("RunOptions: max_seconds must be at least 0");
  if (options.threads < 0) throw std::invalid_argument("RunOptions: threads must be at least 0");
  if (options.max_linear_solves < 0) throw std::invalid_argument("RunOptions: max_linear_solves must be at least 0");
  if (options.history_step < 0) throw std::invalid_argument("RunOptions: history_step must be at least 0");
  if (options.resume && options.folder.empty()) throw std::invalid_argument("RunOptions: resume needs a folder");
  if (options.resume && !options.accelerations.empty())
    throw std::invalid_argument("RunOptions: accelerations are recorded from the beginning, not with resume");
  if (options.resume && options.export_step > 0)
    throw std::invalid_argument("RunOptions: a step is exported in a run from the beginning, not with resume");
}

Budget budget_of(const RunOptions& options) {
  Budget budget;
  budget.stop = options.stop;
  // Beyond a year there is no deadline, which also keeps the sum inside the clock's range.
  if (options.max_seconds > 0 && options.max_seconds < 3e7) {
    budget.deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(Seconds(options.max_seconds));
  }
  return budget;
}

class Run {
 public:
  Run(const Scene& scene, const RunOptions& options)
      : scene_(scene), options_(options), start_(Clock::now()), budget_(budget_of(options)) {}

  RunSummary go();

 private:
  bool begin();
  void loop();
  bool step();
  StepRecord judge(const Problem& problem, const Result& result);
  void find_modes(const Problem& problem, const Vector& x, StepRecord& record);
  void give_up(const Problem& problem, const Result& result);
  void write_step(const StepRecord& record, bool last);
  void write_checkpoint(bool finished);
  void write_checkpoint_if_due();
  void stop_early(Status status, const std::string& where);
  RunSummary finish();
  void take_totals();

  const Scene& scene_;
  const RunOptions& options_;
  Clock::time_point start_, checkpoint_time_;
  double seconds_before_ = 0;  // of earlier processes
  Budget budget_;
  int threads_ = 1;
  std::unique_ptr<Model> model_;
  std::unique_ptr<Stepper> stepper_;
  std::unique_ptr<Solver> own_solver_;
  std::unique_ptr<LimitedSolver> limited_;
  Solver* solver_ = nullptr;
  std::optional<RunFolder> folder_;
  std::optional<FrameOutput> frames_;
  std::optional<AccelerationRecord> accelerations_;
  std::optional<State> before_;  // what the last step started from
  RunSummary summary_;           // of the finished steps
  Seconds checkpoint_cost_{0};
  bool failed_ = false;              // stopped by a step that is not solved
  Status stopped_ = Status::solved;  // interrupted or time_limit
  std::string stopped_message_;
  std::optional<UnfinishedStep> unfinished_;
  std::vector<WorstElement> unfinished_worst_;
  std::vector<NaturalMode> modes_;  // about the end of the last step
};

/// False where an earlier process has finished the run.
bool Run::begin() {
  std::optional<Continuation> from;
  if (!options_.folder.empty()) {
    folder_.emplace(options_.folder);
    if (options_.resume) from = folder_->continuation(scene_, options_.threads);
  }
  if (from) summary_ = from->summary;
  if (from && from->finished) {
    folder_->write_summary(summary_);
    return false;
  }
  const Machine machine = this_machine();
  threads_ = from ? from->threads : options_.threads > 0 ? options_.threads : machine.cores;
  model_ = build_model(scene_);
  stepper_ = std::make_unique<Stepper>(*model_, time_options(scene_));
  if (options_.export_step > 0)
    export_step(scene_, *model_, *stepper_);  // refuses what it cannot write, before any step
  if (!options_.solver) own_solver_ = build_solver(scene_, threads_);
  solver_ = options_.solver ? options_.solver : own_solver_.get();
  if (options_.max_linear_solves > 0) {
    limited_ = std::make_unique<LimitedSolver>(*solver_, options_.max_linear_solves);
    solver_ = limited_.get();
  }

  summary_.input_hash = scene_.hash;
  summary_.problem = scene_.name;
  summary_.solver = solver_->name();
  summary_.steps_asked = scene_.time.steps;
  const std::vector<ProbeValue> measured = std::exchange(summary_.probes, probes_of(scene_));
  for (std::size_t k = 0; k < std::min(measured.size(), summary_.probes.size()); ++k)
    summary_.probes[k].value = measured[k].value;
  if (!from) summary_.notes = model_->notes;
  summary_.version = options_.version;
  summary_.machine = machine;
  summary_.threads = threads_;
  seconds_before_ = summary_.seconds.total;
  if (from) {
    before_ = from->before;
    stepper_->restore(from->state);
  }
  try {
    if (!options_.accelerations.empty()) accelerations_.emplace(scene_, options_.accelerations);
  } catch (const FileError& error) {
    throw RunRefused(error.what());
  }
  if (!folder_) return true;
  const Stopwatch watch(summary_.seconds.output);
  if (from) {
    folder_->go_on(scene_, *from);
  } else {
    folder_->begin(scene_, {false, threads_, stepper_->state(), summary_, {}});
  }
  checkpoint_time_ = Clock::now();
  frames_.emplace(scene_, *model_, folder_->path(), stepper_->state().step);
  if (!from && frames_->frame_is_due(0)) frames_->write_frame(stepper_->state());
  return true;
}

RunSummary Run::go() {
  if (!begin()) return summary_;
  if (options_.on_start) options_.on_start(stepper_->state().step);
  loop();
  return finish();
}

void Run::loop() {
  while (stepper_->state().step < scene_.time.steps) {
    const std::string where = "before step " + std::to_string(stepper_->state().step + 1);
    if (budget_.interrupted()) return stop_early(Status::interrupted, where);
    if (budget_.out_of_time()) return stop_early(Status::time_limit, where);
    if (!step()) return;
  }
}

/// False where the run ends here.
bool Run::step() {
  const Problem& problem = stepper_->problem();
  if (stepper_->state().step + 1 == options_.export_step)
    export_step(scene_, *model_, *stepper_).write(options_.export_file);
  std::optional<History> history;
  if (folder_ && stepper_->state().step + 1 == options_.history_step) history.emplace(*solver_, problem);
  Result result = solve_step(*stepper_, *solver_, scene_.solver.tolerance, scene_.time.halvings, budget_);
  if (limited_ && limited_->used_up() && result.status == Status::limit_point) {  // no turn of the path
    result.status = Status::iteration_limit;
    result.message = limited_->message();
  }
  if (history) folder_->write_history(history->points());
  history.reset();
  const bool cut_short = (result.status == Status::interrupted && budget_.interrupted()) ||
                         (result.status == Status::time_limit && budget_.out_of_time());
  if (cut_short) {
    give_up(problem, result);
    return false;
  }
  StepRecord record = judge(problem, result);
  const bool usable = result.x.allFinite();
  failed_ = record.status != Status::solved && (scene_.solver.on_failure == scene::OnFailure::stop || !usable);
  const bool last = failed_ || record.step == scene_.time.steps;
  const bool first_failure = record.status != Status::solved && summary_.status == Status::solved;
  if (first_failure || (last && summary_.status == Status::solved)) {
    summary_.worst_elements = worst_elements(problem, result.x, worst_elements_kept);
    summary_.worst_elements_step = record.step;
  }
  if (usable) {
    if (folder_ || accelerations_) before_ = stepper_->state();
    stepper_->accept(result);
    if (accelerations_) accelerations_->take(*before_, stepper_->state());
    record.time = stepper_->time();
    const Stopwatch watch(record.judging);
    record.energies = stepper_->energies();
  }
  add_step(summary_, record);
  if (folder_) write_step(record, last && usable);
  if (options_.on_step) options_.on_step(record);
  return !failed_;
}

StepRecord Run::judge(const Problem& problem, const Result& result) {
  StepRecord record;
  {
    const Stopwatch watch(record.judging);
    record.residuals = residuals(problem, result);
    record.penetrations = penetrations(*model_, result.x);
    record.objective = objective(problem, result.x);
  }
  name_for_people(record.residuals, problem, *model_);
  record.step = stepper_->state().step + 1;
  record.time = stepper_->time() + stepper_->options().step;
  record.status = record.claimed = result.status;
  record.message = result.message;
  record.counts = result.counts;
  record.seconds = result.timings;
  if (result.status == Status::solved && !record.residuals.within(scene_.solver.tolerance)) {
    record.status = record.residuals.finite ? Status::stalled : Status::not_finite;
    record.message = solver_->name() + " says solved, but the residuals are not within tolerance";
  }
  const Stopwatch watch(record.judging);
  if (record.status == Status::solved) find_modes(problem, result.x, record);
  const std::vector<double> values = probe_values(scene_, *model_, problem, result.x, modes_);
  for (std::size_t k = 0; k < values.size(); ++k) record.probes.emplace_back(scene_.output.probes[k].name, values[k]);
  for (std::size_t k = 0; k < result.penalties.size() && k < problem.constraints.size(); ++k) {
    record.penalties.emplace_back(problem.constraints[k]->name(), result.penalties[k]);
  }
  return record;
}

/// Natural modes about the end of the last step; it is not solved without them.
void Run::find_modes(const Problem& problem, const Vector& x, StepRecord& record) try {
  modes_ = modes_at(scene_, *model_, problem, x, record.step, threads_);
  for (const NaturalMode& mode : modes_) {
    record.modes.push_back({mode.frequency, mode.residual});
    if (mode.residual <= scene_.solver.tolerance.stationarity) continue;
    record.status = Status::stalled;
    record.message =
        "the mode of " + std::to_string(mode.frequency) + " Hz has a residual that is not within tolerance";
  }
} catch (const std::exception& error) {  // more modes than variables, or no convergence
  record.status = Status::stalled;
  record.message = error.what();
}

void Run::give_up(const Problem& problem, const Result& result) {
  const int step = stepper_->state().step + 1;
  const Residuals r = residuals(problem, result);
  unfinished_ = UnfinishedStep{step, result.message, r.stationarity, r.feasibility, r.complementarity};
  unfinished_worst_ = worst_elements(problem, result.x, worst_elements_kept);
  stop_early(result.status, "in step " + std::to_string(step));
}

void Run::stop_early(Status status, const std::string& where) {
  stopped_ = status;
  stopped_message_ = (status == Status::interrupted ? "interrupted " : "time is over ") + where;
}

void Run::write_step(const StepRecord& record, bool last) {
  const Stopwatch watch(summary_.seconds.output);
  folder_->append_step(record);
  if (record.step == stepper_->state().step) {
    if (last || frames_->frame_is_due(record.step)) frames_->write_frame(stepper_->state());
    if (!modes_.empty()) frames_->write_modes(stepper_->state(), modes_);
    if ((last && scene_.output.pictures > 0) || frames_->picture_is_due(record.step)) {
      const std::string problem = frames_->write_picture(stepper_->state());
      if (!problem.empty()) summary_.notes.push_back(problem);
    }
  }
  if (!last && !failed_) write_checkpoint_if_due();
}

void Run::write_checkpoint_if_due() {
  const Seconds since = Clock::now() - checkpoint_time_;
  if (since >= std::min(longest_without_checkpoint, checkpoint_cost_ / checkpoint_share)) {
    take_totals();
    write_checkpoint(false);
  }
}

void Run::write_checkpoint(bool finished) {
  const Clock::time_point begin = Clock::now();
  frames_->write_index();
  folder_->write_checkpoint(scene_.hash, {finished, threads_, stepper_->state(), summary_, before_});
  checkpoint_time_ = Clock::now();
  checkpoint_cost_ = checkpoint_time_ - begin;
}

void Run::take_totals() {
  summary_.seconds.total = seconds_before_ + Seconds(Clock::now() - start_).count();
  summary_.peak_memory_bytes = std::max(summary_.peak_memory_bytes, peak_memory_bytes());
}

RunSummary Run::finish() {
  take_totals();
  if (accelerations_) accelerations_->finish();
  RunSummary ended = summary_;
  if (stopped_ != Status::solved) {
    ended.status = stopped_;
    ended.message = stopped_message_;
    ended.unfinished = unfinished_;
    if (unfinished_) {
      ended.worst_elements = unfinished_worst_;
      ended.worst_elements_step = unfinished_->step;
    }
  }
  if (folder_) {
    frames_->write_index();  // before the summary, which lists it
    // The checkpoint says "finished" only once the summary is there.
    folder_->write_summary(ended);
    write_checkpoint(stopped_ == Status::solved);
  }
  return ended;
}

}  // namespace

RunSummary run(const Scene& scene, const RunOptions& options) {
  check(options);
  return Run(scene, options).go();
}

}  // namespace taut
