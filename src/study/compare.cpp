#include "study/compare.h"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "study/compare_entry.h"
#include "study/compare_folder.h"
#include "study/machine.h"
#include "study/unique_name.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

void check(const CompareOptions& options) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("CompareOptions: ") + what);
  };
  require(!options.problems.empty(), "expected problems, got none");
  require(options.steps >= 0, "steps must be at least 0");
  require(options.repeat >= 1, "repeat must be at least 1");
  require(options.threads >= 0, "threads must be at least 0");
  require(options.time_limit >= 0, "time_limit must be at least 0");
  require(options.memory_limit_bytes >= 0, "memory_limit_bytes must be at least 0");
  require(!options.worker.empty(), "expected a worker's command, got none");
}

EntryRun planned_run(const PlannedEntry& entry, int steps) {
  EntryRun run;
  run.label = entry.label;
  run.solver = entry.solver;
  run.group = entry.group;
  run.overrides = entry.overrides;
  run.tolerance = entry.scene.solver.tolerance;
  run.steps_asked = steps;
  run.outcome = "interrupted";
  return run;
}

class Compare {
 public:
  explicit Compare(const CompareOptions& options) : options_(options), folder_(options.folder, options.resume) {}
  Comparison go();

 private:
  void plan();
  void compare_problem(const ProblemPlan& plan, ProblemComparison& problem);
  int follow_reference(const ProblemPlan& plan, ProblemComparison& problem);
  void carry_out(const CompareJob& job, EntryRun& run);
  CompareJob job_of(const PlannedEntry& entry, const ProblemPlan& plan, int steps) const;
  bool stopped() const { return options_.stop && options_.stop->load(std::memory_order_relaxed); }

  const CompareOptions& options_;
  CompareFolder folder_;
  std::vector<ProblemPlan> plans_;
  Comparison comparison_;
};

/// Everything about the problems that can go wrong does so here, before anything is written.
void Compare::plan() {
  std::set<std::string> names;
  for (const fs::path& file : options_.problems) {
    const ProblemPlan& plan = plans_.emplace_back(plan_problem(file, options_.choice));
    ProblemComparison problem;
    problem.name = plan.reference.scene.name;
    problem.file = fs::absolute(file).string();
    problem.hash = plan.reference.scene.hash;
    problem.folder = unique_name(problem.name, names);
    problem.size = plan.size;
    problem.steps_asked = plan.reference.scene.time.steps;
    if (options_.steps > 0) problem.steps_asked = std::min(problem.steps_asked, options_.steps);
    problem.trajectory = planned_run(plan.reference, problem.steps_asked);
    problem.trajectory.folder = problem.folder + "/reference";
    std::set<std::string> entries{"reference", "states"};
    for (const PlannedEntry& entry : plan.entries) {
      EntryRun& run = problem.entries.emplace_back(planned_run(entry, problem.steps_asked));
      run.folder = problem.folder + "/" + unique_name(run.label, entries);
    }
    comparison_.problems.push_back(std::move(problem));
  }
  comparison_.free = options_.free;
  comparison_.cold = options_.cold;
  comparison_.repeat = options_.repeat;
  comparison_.threads = options_.threads;
  comparison_.time_limit = options_.time_limit;
  comparison_.memory_limit_bytes = options_.memory_limit_bytes;
  comparison_.version = options_.version;
  comparison_.machine = this_machine();
}

CompareJob Compare::job_of(const PlannedEntry& entry, const ProblemPlan& plan, int steps) const {
  CompareJob job;
  job.problem = fs::absolute(plan.file).string();
  job.overrides = entry.overrides;
  job.cold = options_.cold;
  job.steps = steps;
  job.repeat = options_.repeat;
  job.threads = options_.threads;
  job.seconds = options_.time_limit;
  job.memory_bytes = options_.memory_limit_bytes;
  job.scene_hash = entry.scene.hash;
  job.version = options_.version;
  if (options_.free) return job;
  job.states = "../states";
  job.trajectory_hash = plan.reference.scene.hash;
  return job;
}

void Compare::carry_out(const CompareJob& job, EntryRun& run) {
  if (stopped()) return;
  run_entry(folder_.path() / run.folder, job, {options_.worker, options_.resume, options_.stop}, run);
  if (options_.on_run) options_.on_run(run);
}

/// The number of states that the reference has left.
int Compare::follow_reference(const ProblemPlan& plan, ProblemComparison& problem) {
  CompareJob job = job_of(plan.reference, plan, problem.steps_asked);
  job.records = true;
  job.cold = false;
  job.repeat = 1;
  carry_out(job, problem.trajectory);
  problem.trajectory_solved = summarize(problem.trajectory).solved == problem.steps_asked;
  const fs::path states = folder_.path() / problem.folder / "states";
  int count = 0;
  while (count < problem.steps_asked && fs::exists(step_file(states, count))) ++count;
  return count;
}

void Compare::compare_problem(const ProblemPlan& plan, ProblemComparison& problem) {
  const int steps = options_.free ? problem.steps_asked : follow_reference(plan, problem);
  for (std::size_t k = 0; k < plan.entries.size(); ++k) {
    EntryRun& run = problem.entries[k];
    if (stopped()) return;
    if (steps > 0) run.steps_asked = steps;
    if (steps == 0) {
      run.outcome = "no_states";
      run.message = "the reference has left no state to start from";
      continue;
    }
    carry_out(job_of(plan.entries[k], plan, steps), run);
  }
  measure_distances(problem.entries, plan.reference.scene.solver.tolerance, problem.size,
                    [&](std::size_t entry, std::size_t trial) {
                      const EntryRun& run = problem.entries[entry];
                      return read_positions(folder_.path() / run.folder, run.trials[trial].step);
                    });
  mark_front(problem.entries);
}

Comparison Compare::go() {
  plan();
  comparison_.interrupted = true;  // until the end is reached
  folder_.begin(comparison_);
  if (options_.on_start) {
    std::size_t processes = 0;
    for (const ProblemPlan& plan : plans_) processes += plan.entries.size() + (options_.free ? 0 : 1);
    options_.on_start(static_cast<int>(processes));
  }
  for (std::size_t k = 0; k < plans_.size() && !stopped(); ++k) compare_problem(plans_[k], comparison_.problems[k]);
  comparison_.interrupted = stopped();
  folder_.write(comparison_);
  return comparison_;
}

}  // namespace

Comparison compare(const CompareOptions& options) {
  check(options);
  return Compare(options).go();
}

}  // namespace taut
