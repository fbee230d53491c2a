#include "study/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "files/atomic_file.h"
#include "study/chart_json.h"
#include "study/machine.h"
#include "study/run_folder.h"
#include "study/solver_entries.h"
#include "study/unique_name.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

constexpr const char* chart_file = "chart.json";
constexpr const char* runs_folder = "runs";

void check(const ChartOptions& options) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("ChartOptions: ") + what);
  };
  require(!options.choice.problems.empty(), "expected problems, got none");
  require(!options.choice.solvers.empty(), "expected solvers, got none");
  require(static_cast<bool>(options.find), "expected a way to find problems");
  require(options.max_seconds > 0, "max_seconds must be above 0");
  require(options.accuracy > 0, "accuracy must be above 0");
  require(options.threads >= 0, "threads must be at least 0");
  require(!options.program.empty(), "expected a command, got none");
}

/// Throws RunRefused for a folder that is neither missing, nor empty, nor a chart's.
void check_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return;
  if (!fs::is_directory(folder, error)) throw RunRefused(folder.string() + ": is not a directory");
  if (!fs::is_empty(folder, error) && !fs::exists(folder / chart_file, error)) {
    throw RunRefused(folder.string() +
                     ": is not empty and holds no chart of taut; nothing was touched, choose another directory");
  }
}

/// Each once, and only some with a knob that others ignore.
void check_solvers(const ChartChoice& choice) {
  std::set<std::string> seen;
  for (const std::string& solver : choice.solvers) {
    solver_entry(solver);
    if (!seen.insert(solver).second) throw InputError("--solvers: found " + solver + " twice, allowed: each once");
    if (choice.knob.kind == KnobKind::penalty && (solver == "ipopt" || solver == "nlopt"))
      throw InputError("--vary penalty: " + solver + " has no penalty, allowed: augmented Lagrangians");
  }
  if (!choice.reference.empty()) solver_entry(choice.reference, "--reference");
}

class ChartMaker {
 public:
  explicit ChartMaker(const ChartOptions& options) : options_(options) {
    process_ = {.program = options.program,
                .folder = options.folder,
                .threads = options.threads > 0 ? options.threads : this_machine().cores,
                .max_seconds = options.max_seconds,
                .memory_limit_bytes = options.memory_limit_bytes,
                .resume = options.resume,
                .stop = options.stop,
                .version = options.version};
  }

  ChartData go();

 private:
  void plan();
  void begin() const;
  void run_problem(const ChartPlan& plan, ProblemChart& problem);
  void carry_out(const ChartJob& job, ChartPoint& point);
  std::optional<Vector> solve_reference(const ChartPlan& plan, const PlannedReference& planned,
                                        ChartReference& reference);
  std::optional<Vector> climb(const ChartPlan& plan, const PlannedReference& planned, const ReferenceLadder& ladder,
                              ChartReference& reference);
  void measure(const ChartPlan& plan, ProblemChart& problem, const std::vector<std::optional<Vector>>& references);
  std::optional<Vector> observed(const ChartPlan& plan, const PlannedRun& run, const ChartPoint& point) const;
  void follow(const ChartPlan& plan, ProblemChart& problem);
  /// A folder for a run of a problem, relative to the chart's.
  std::string folder_of(std::size_t problem, const std::string& name) {
    return chart_.problems[problem].folder + "/" + unique_name(name, names_[problem]);
  }
  std::size_t index_of(const ChartPlan& plan) const { return static_cast<std::size_t>(&plan - plans_.data()); }
  bool stopped() const { return options_.stop && options_.stop->load(std::memory_order_relaxed); }
  void done(const ChartPoint& point) const {
    if (options_.on_task) options_.on_task(point);
  }

  const ChartOptions& options_;
  ChartProcess process_;
  std::vector<ChartPlan> plans_;
  std::vector<std::set<std::string>> names_;  // by problem
  ChartData chart_;
};

std::string point_name(const ChartPoint& point) {
  return point.value.empty() ? point.solver : point.solver + " " + point.value;
}

ChartPoint planned_point(const std::string& solver, const PlannedRun& run, const ChartProcess& process) {
  ChartPoint point;
  point.solver = solver;
  point.value = run.value;
  point.command = solve_words(run.job, process);
  return point;
}

/// Everything about the problems that can go wrong does so here, before anything is written.
void ChartMaker::plan() {
  check_solvers(options_.choice);
  chart_.knob = options_.choice.knob;
  chart_.solvers = options_.choice.solvers;
  chart_.max_seconds = options_.max_seconds;
  chart_.accuracy = options_.accuracy;
  chart_.threads = process_.threads;
  chart_.version = options_.version;
  chart_.machine = this_machine();
  std::set<std::string> problems;
  for (const std::string& given : options_.choice.problems) {
    const std::size_t index = plans_.size();
    const ChartPlan& plan = plans_.emplace_back(plan_chart(given, options_.choice, options_.find));
    ProblemChart& problem = chart_.problems.emplace_back();
    problem.name = plan.scene.name;
    problem.problem = given;
    problem.folder = std::string(runs_folder) + "/" + unique_name(problem.name, problems);
    names_.emplace_back();
    problem.error = plan.measure.kind;
    problem.size = plan.measure.size;
    for (std::size_t k = 0; k < plan.runs.size(); ++k) {
      const std::size_t value = k % plan.values.size();
      ChartPoint& point = problem.points.emplace_back(
          planned_point(options_.choice.solvers[k / plan.values.size()], plan.runs[k], process_));
      point.number = plan.values[value].number;
      point.folder = folder_of(index, point_name(point));
      point.steps_asked = plan.scene.time.steps;
    }
    for (const PlannedReference& planned : plan.references) problem.references.emplace_back().group = planned.group;
    for (std::size_t k = 0; k < plan.histories.size(); ++k) {
      ChartHistory& history = problem.histories.emplace_back();
      history.run = planned_point(options_.choice.solvers[k], plan.histories[k], process_);
      history.run.folder = folder_of(index, "history " + history.run.solver);
      history.step = plan.histories[k].job.history_step;
    }
  }
}

void ChartMaker::begin() const {
  std::error_code error;
  fs::create_directories(options_.folder, error);
  if (error) throw RunRefused(options_.folder.string() + ": cannot be created: " + error.message());
  if (!options_.resume) {
    for (const char* earlier : {runs_folder, "report.json", "chart.csv"}) fs::remove_all(options_.folder / earlier);
    for (const auto& entry : fs::directory_iterator(options_.folder)) {
      if (entry.path().extension() == ".svg") fs::remove(entry.path());
    }
  }
  write_atomically(options_.folder / chart_file, chart_text(chart_));
}

void ChartMaker::carry_out(const ChartJob& job, ChartPoint& point) {
  if (!stopped()) run_point(process_, job, point);
}

std::optional<Vector> ChartMaker::observed(const ChartPlan& plan, const PlannedRun& run, const ChartPoint& point) const
    try {
  if (point.outcome != "finished") return {};
  return observe(read_stored_run(run_folder(process_, point)), plan.measure, run.points);
} catch (const std::exception&) {
  return {};  // the run is damaged, which its point says
}

/// The reference by one ladder; nothing where its finest rung is not solved.
std::optional<Vector> ChartMaker::climb(const ChartPlan& plan, const PlannedReference& planned,
                                        const ReferenceLadder& ladder, ChartReference& reference) {
  std::vector<Vector> found;
  std::string rungs;
  for (const PlannedRun& rung : ladder.rungs) {
    ChartPoint& point = reference.runs.emplace_back(planned_point(ladder.solver, rung, process_));
    point.folder = folder_of(index_of(plan), "reference " + point_name(point));
    carry_out(rung.job, point);
    const std::optional<Vector> end = observed(plan, rung, point);
    if (!point.solved() || !end) break;
    found.push_back(*end);
    rungs += (rungs.empty() ? "" : ", ") + rung.value;
    if (!planned.refines && found.size() > 1 && plan.measure(*end, found.front()) > 0) break;
  }
  if (found.empty()) return {};
  reference.solver = ladder.solver;
  reference.kind = "solution";
  const std::string whose = chart_.knob.kind == KnobKind::model ? "the last model by " : "";
  const ErrorMeasure& measure = plan.measure;
  std::optional<Richardson> extrapolated;
  if (planned.refines && found.size() == 3) {
    extrapolated =
        richardson(found[2], found[1], found[0], 2, [&](const Vector& a, const Vector& b) { return measure(a, b); });
  }
  if (extrapolated) {
    reference.kind = "extrapolation";
    reference.order = extrapolated->order;
    reference.estimated_error = extrapolated->error;
    reference.text = fmt::format("{}{} at {}, extrapolated with their order of {:.2f}", whose, ladder.solver, rungs,
                                 *reference.order);
    return extrapolated->limit;
  }
  reference.text =
      fmt::format("{}{} at {}", whose, ladder.solver, planned.refines ? rungs : ladder.rungs.front().value);
  // Of tolerances the last differs, of refinements the second is the next coarser.
  const double difference = measure(planned.refines && found.size() > 1 ? found[1] : found.back(), found.front());
  if (difference > 0) reference.estimated_error = difference;
  if (planned.refines) {
    reference.text += found.size() == 3 ? ", the first of them: their differences follow no order"
                                        : ", the first of them: too few for an order";
  } else if (difference > 0) {
    reference.text += ", compared with " + reference.runs.back().value;
  }
  return found.front();
}

std::optional<Vector> ChartMaker::solve_reference(const ChartPlan& plan, const PlannedReference& planned,
                                                  ChartReference& reference) {
  if (plan.measure.kind == ErrorKind::violation) {
    reference.kind = "none needed";
    reference.text = "a violation is an error by itself";
    return {};
  }
  if (plan.measure.expected) {
    reference.kind = "closed form";
    reference.text = plan.measure.source;
    return plan.measure.expected;
  }
  reference.text = "no solver has solved the reference";
  for (const ReferenceLadder& ladder : planned.ladders) {
    if (stopped()) break;
    const bool too_slow = !reference.runs.empty() && reference.runs.back().solver == ladder.solver &&
                          reference.runs.back().status == "time_limit";
    if (too_slow) continue;
    const std::optional<Vector> found = climb(plan, planned, ladder, reference);
    if (!found) continue;
    for (const std::string& solver : chart_.solvers) {
      if (method_of(solver) == method_of(ladder.solver)) reference.not_independent_of.push_back(solver);
    }
    return found;
  }
  return {};
}

void ChartMaker::measure(const ChartPlan& plan, ProblemChart& problem,
                         const std::vector<std::optional<Vector>>& references) {
  for (std::size_t k = 0; k < problem.points.size(); ++k) {
    ChartPoint& point = problem.points[k];
    if (plan.measure.kind == ErrorKind::violation) {
      if (point.steps_done > 0 && std::isfinite(point.violation)) point.error = point.violation;
      continue;
    }
    const std::size_t group = references.size() > 1 ? k % plan.values.size() : 0;
    const std::optional<Vector> end = observed(plan, plan.runs[k], point);
    if (!end || !references[group] || end->size() != references[group]->size()) continue;
    const double error = plan.measure(*end, *references[group]);
    if (std::isfinite(error)) point.error = error;
  }
  mark_front(problem.points);
}

void ChartMaker::follow(const ChartPlan& plan, ProblemChart& problem) {
  for (std::size_t k = 0; k < problem.histories.size() && !stopped(); ++k) {
    ChartHistory& history = problem.histories[k];
    carry_out(plan.histories[k].job, history.run);
    const fs::path file = run_folder(process_, history.run) / "history.csv";
    if (fs::exists(file)) history.points = read_history(file);
    done(history.run);
  }
}

void ChartMaker::run_problem(const ChartPlan& plan, ProblemChart& problem) {
  for (std::size_t k = 0; k < plan.runs.size() && !stopped(); ++k) {
    carry_out(plan.runs[k].job, problem.points[k]);
    done(problem.points[k]);
  }
  std::vector<std::optional<Vector>> references(plan.references.size());
  for (std::size_t k = 0; k < plan.references.size() && !stopped(); ++k) {
    references[k] = solve_reference(plan, plan.references[k], problem.references[k]);
    if (!problem.references[k].runs.empty()) done(problem.references[k].runs.back());
  }
  measure(plan, problem, references);
  follow(plan, problem);
}

ChartData ChartMaker::go() {
  check_folder(options_.folder);
  plan();
  chart_.interrupted = true;  // until the end is reached
  begin();
  if (options_.on_start) {
    std::size_t tasks = 0;
    for (const ChartPlan& plan : plans_) {
      tasks += plan.runs.size() + plan.histories.size();
      for (const PlannedReference& reference : plan.references) tasks += reference.ladders.empty() ? 0 : 1;
    }
    options_.on_start(static_cast<int>(tasks));
  }
  for (std::size_t k = 0; k < plans_.size() && !stopped(); ++k) run_problem(plans_[k], chart_.problems[k]);
  chart_.interrupted = stopped();
  write_atomically(options_.folder / chart_file, chart_text(chart_));
  return chart_;
}

}  // namespace

ChartData chart(const ChartOptions& options) {
  check(options);
  return ChartMaker(options).go();
}

}  // namespace taut
