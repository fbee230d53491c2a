#include "study/chart_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "problems/build.h"
#include "study/compare_plan.h"
#include "study/solver_entries.h"

namespace taut {
namespace {

/// Runs go on after a step that is not solved, so that their error can be measured; nothing but numbers is kept.
const Overrides of_every_run{{"solver.on_failure", "continue"}, {"output.pictures", "0"}};

constexpr double tighter = 100, next_tighter = 10;  // tolerance of references over the tightest that is charted
constexpr double tightest = 1e-12;

double smallest_tolerance(const Scene& scene) {
  const Tolerances& t = scene.solver.tolerance;
  return std::min({t.stationarity, t.feasibility, t.complementarity});
}

class Planner {
 public:
  Planner(const std::string& problem, const ChartChoice& choice, const FindProblem& find)
      : choice_(choice), find_(find) {
    plan_.problem = problem;
  }

  ChartPlan go() {
    plan_.scene = read(job_of(choice_.solvers.front(), {}, {}));
    plan_.values = values_of(choice_.knob, plan_.scene);
    plan_.measure = error_measure(error_kind(), plan_.scene, diagonal(build_model(plan_.scene)->start()));
    plan_runs();
    plan_references();
    if (plan_.measure.kind == ErrorKind::position) share_vertices();
    plan_histories();
    return std::move(plan_);
  }

 private:
  ErrorKind error_kind() const {
    if (choice_.error) return *choice_.error;
    const auto& probes = plan_.scene.output.probes;
    const bool closed = std::any_of(probes.begin(), probes.end(), [](const scene::Probe& p) { return p.expected; });
    return closed ? ErrorKind::probe : ErrorKind::position;
  }

  /// The value's own overrides come last but for `more`.
  ChartJob job_of(const std::string& solver, const KnobValue& value, const Overrides& more) const {
    ChartJob job;
    job.problem = value.problem.empty() ? plan_.problem : value.problem;
    const auto add = [&job](const Overrides& overrides) {
      job.overrides.insert(job.overrides.end(), overrides.begin(), overrides.end());
    };
    add(of_every_run);
    add(choice_.settings);
    add(solver_entry(solver).overrides);
    add(value.overrides);
    add(more);
    if (solver == "fixed_penalty")
      for (auto& [key, text] : job.overrides)
        if (key == "solver.penalty") key = "solver.fixed_penalty";
    return job;
  }

  Scene read(const ChartJob& job) const { return read_scene(find_(job.problem), job.overrides); }

  void check_solver(const PlannedRun& run) const { build_solver(read(run.job), 1); }

  /// Builds the run's model, unless one with the same meshes has been, and keeps the vertices that it starts from.
  void take(PlannedRun& run) {
    std::string meshes = run.job.problem;
    for (const auto& [key, value] : run.job.overrides) {
      if (!key.starts_with("solver.") && !key.starts_with("time.")) meshes += " " + key + "=" + value;
    }
    const auto [known, is_new] = start_of_.emplace(meshes, starts_.size());
    starting_.emplace_back(&run, known->second);
    if (!is_new) return;
    const std::unique_ptr<Model> model = build_model(read(run.job));
    starts_.push_back({model->bodies, model->start()});
  }

  void plan_runs() {
    plan_.runs.reserve(choice_.solvers.size() * plan_.values.size());
    for (const std::string& solver : choice_.solvers) {
      for (const KnobValue& value : plan_.values) {
        PlannedRun& run = plan_.runs.emplace_back(PlannedRun{job_of(solver, value, {}), value.label, {}});
        check_solver(run);
        take(run);
      }
    }
  }

  void plan_histories() {
    if (choice_.history_step == 0) return;
    for (const std::string& solver : choice_.solvers) {
      PlannedRun& run = plan_.histories.emplace_back(PlannedRun{job_of(solver, {}, {}), "", {}});
      const int steps = plan_.scene.time.steps, step = choice_.history_step < 0 ? steps : choice_.history_step;
      if (step > steps) throw InputError(fmt::format("--history {}: {} has {} steps", step, plan_.scene.name, steps));
      run.job.history_step = step;
      // Loads of a static step depend on the number of steps.
      if (plan_.scene.time.integrator != scene::Integrator::quasi_static)
        run.job.overrides.emplace_back("time.steps", std::to_string(step));
    }
  }

  void plan_references() {
    if (plan_.measure.kind == ErrorKind::violation || plan_.measure.expected) {
      plan_.references.emplace_back();
    } else if (choice_.knob.kind == KnobKind::key && !keeps_the_problem(choice_.knob)) {
      for (const KnobValue& value : plan_.values) plan_reference(value.label, value);
    } else {
      // A model's truth is the last one given; the other knobs share one problem.
      plan_reference("", choice_.knob.kind == KnobKind::model ? plan_.values.back() : KnobValue{});
    }
  }

  void plan_reference(const std::string& group, const KnobValue& value) {
    PlannedReference& reference = plan_.references.emplace_back();
    reference.group = group;
    const KnobKind kind = choice_.knob.kind;
    reference.refines = kind == KnobKind::step || kind == KnobKind::mesh || kind == KnobKind::integrator;
    for (const std::string& solver : reference_solvers()) {
      try {
        for (const ReferenceLadder& ladder : reference.refines ? refined(solver) : tightened(solver, value)) {
          for (const PlannedRun& rung : ladder.rungs) check_solver(rung);
          reference.ladders.push_back(ladder);
        }
      } catch (const InputError&) {
        // A solver that this build or this problem does not have; where it was asked for, that is an error.
        if (!choice_.reference.empty()) throw;
      }
    }
    for (ReferenceLadder& ladder : reference.ladders)
      for (PlannedRun& rung : ladder.rungs) take(rung);
  }

  /// The asked one, or those of methods that are not charted before others.
  std::vector<std::string> reference_solvers() const {
    if (!choice_.reference.empty()) return {choice_.reference};
    std::vector<std::string> order{"ipopt", "null_space", "multiplier_loop", "augmented_lagrangian"};
    const auto charted = [this](const std::string& solver) {
      return std::any_of(choice_.solvers.begin(), choice_.solvers.end(),
                         [&](const std::string& other) { return method_of(other) == method_of(solver); });
    };
    std::stable_partition(order.begin(), order.end(), [&](const std::string& solver) { return !charted(solver); });
    return order;
  }

  /// Tighter tolerances: a hundred times, or ten times where that is not reached; looser ones tell the error.
  std::vector<ReferenceLadder> tightened(const std::string& solver, const KnobValue& value) const {
    double charted = smallest_tolerance(read(job_of(solver, value, {})));
    if (choice_.knob.kind == KnobKind::tolerance) {
      charted = std::min_element(plan_.values.begin(), plan_.values.end(), [](const KnobValue& a, const KnobValue& b) {
                  return a.number < b.number;
                })->number;
    }
    std::vector<ReferenceLadder> ladders;
    for (const double factor : {tighter, next_tighter}) {
      const double tolerance = std::max(charted / factor, tightest);
      ReferenceLadder& ladder = ladders.emplace_back(ReferenceLadder{solver, tolerance, {}});
      // A solver may end with the same bits at several tolerances, of which the first that differs tells the error.
      for (const double looser : {1.0, 10.0, 100.0, 1000.0})
        ladder.rungs.push_back(rung_of(solver, value, {}, looser * tolerance));
    }
    return ladders;
  }

  /// Half the finest step or width, and twice and four times that.
  std::vector<ReferenceLadder> refined(const std::string& solver) const {
    KnobKind kind = choice_.knob.kind;
    double finest = 0;
    Overrides more;
    if (kind == KnobKind::integrator) {
      kind = KnobKind::step;
      finest = plan_.scene.time.step / 4;
      more.emplace_back("time.integrator", "bdf2");
    } else {
      finest = std::min_element(plan_.values.begin(), plan_.values.end(), [](const KnobValue& a, const KnobValue& b) {
                 return a.number < b.number;
               })->number;
    }
    ReferenceLadder ladder{solver, std::max(smallest_tolerance(plan_.scene) / next_tighter, tightest), {}};
    for (const double factor : {0.5, 1.0, 2.0}) {
      try {
        const KnobValue value = numbered_value(kind, factor * finest, plan_.scene);
        ladder.rungs.push_back(rung_of(solver, value, more, ladder.tolerance));
      } catch (const InputError&) {
        if (factor < 1) throw;  // the coarser ones only tell the error
        break;
      }
    }
    return {ladder};
  }

  PlannedRun rung_of(const std::string& solver, const KnobValue& value, Overrides more, double tolerance) const {
    const KnobValue tight = numbered_value(KnobKind::tolerance, tolerance, plan_.scene);
    more.insert(more.end(), tight.overrides.begin(), tight.overrides.end());
    PlannedRun run{job_of(solver, value, more), value.label, {}};
    run.value += (run.value.empty() ? "" : " ") + ("tolerance " + tight.label);
    return run;
  }

  void share_vertices() {
    const auto common = common_points(starts_, plan_.measure.size);
    if (common.empty() || common.front().empty())
      throw InputError("--error position: the meshes of " + plan_.scene.name +
                       " have no vertex in common; allowed: meshes that are refined from each other, or --error probe");
    for (const auto& [run, start] : starting_) run->points = common[start];
  }

  const ChartChoice& choice_;
  const FindProblem& find_;
  ChartPlan plan_;
  std::vector<StartingPoints> starts_;
  std::map<std::string, std::size_t> start_of_;                // by what makes the meshes
  std::vector<std::pair<PlannedRun*, std::size_t>> starting_;  // the runs stay in place
};

}  // namespace

std::string method_of(const std::string& solver) {
  return solver == "ipopt" || solver == "nlopt" || solver == "alternating" ? solver : "augmented_lagrangian";
}

ChartPlan plan_chart(const std::string& problem, const ChartChoice& choice, const FindProblem& find) {
  return Planner(problem, choice, find).go();
}

}  // namespace taut
