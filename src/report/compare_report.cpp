#include "report/compare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "problems/build.h"
#include "report/command_text.h"
#include "report/viewer_data.h"
#include "study/compare_entry.h"
#include "study/solver_entries.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t most_columns = 40;  // of a heat map
constexpr std::size_t most_others = 6;    // entries whose distance the viewer shows

Frame frame_of(const Vector& positions) {
  Frame frame;
  frame.positions = positions;
  return frame;
}

double largest_residual(const Residuals& r) {
  return r.finite ? std::max({r.stationarity, r.feasibility, r.complementarity}) : HUGE_VAL;
}

/// "solved" where every step asked for is, else what went wrong first.
std::string status_of(const EntryRun& run, const EntrySummary& summary) {
  if (summary.false_successes > 0) return "false success";
  if (run.outcome != "finished") return run.outcome;
  return summary.solved == run.steps_asked ? "solved" : summary.failures.begin()->first;
}

/// The command that compares this entry alone, from the same states.
std::string command_of(const Comparison& comparison, const ProblemComparison& problem, const EntryRun& run) {
  std::vector<std::string> words{"taut", "compare", problem.file, "--solvers", run.solver};
  if (!comparison.free) words.insert(words.end(), {"--reference", problem.trajectory.solver});
  words.insert(words.end(), {"--steps", std::to_string(problem.steps_asked), "--repeat",
                             std::to_string(comparison.repeat), "--threads", std::to_string(comparison.threads)});
  const Overrides& implied = solver_entry(run.solver).overrides;
  for (const auto& setting : run.overrides) {
    if (std::find(implied.begin(), implied.end(), setting) != implied.end()) continue;
    words.insert(words.end(), {"--set", setting.first + "=" + setting.second});
  }
  if (comparison.free) words.push_back("--free");
  if (comparison.cold) words.push_back("--cold");
  return command_text(words);
}

/// A number of each entry against its time, a series for each solver.
template <class Value>
Json time_chart(const Comparison& comparison, const ProblemComparison& problem, const std::string& id,
                const std::string& title, const std::string& y, Value value) {
  Json series = Json::array();
  for (const EntryRun& run : problem.entries) {
    if (run.trials.empty()) continue;
    const EntrySummary summary = summarize(run);
    auto same = std::find_if(series.begin(), series.end(), [&](const Json& one) { return one["name"] == run.solver; });
    if (same == series.end()) {
      series.push_back({{"name", run.solver}, {"line", true}, {"points", Json::array()}});
      same = std::prev(series.end());
    }
    (*same)["points"].push_back({{"x", summary.seconds.median},
                                 {"y", value(summary)},
                                 {"status", status_of(run, summary)},
                                 {"label", run.label},
                                 {"command", command_of(comparison, problem, run)}});
  }
  return {{"id", id + "_" + problem.folder},
          {"title", problem.name + ": " + title},
          {"x", {{"label", "seconds a step"}, {"log", true}}},
          {"y", {{"label", y}, {"log", true}}},
          {"series", series}};
}

Json error_chart(const Comparison& comparison, const ProblemComparison& problem) {
  Json chart =
      time_chart(comparison, problem, "error", "error against time", "largest distance to the reference / size",
                 [](const EntrySummary& s) { return s.distances > 0 ? Json(s.position_distance) : Json(); });
  std::map<double, double> front;  // by seconds; one line can show one problem only
  for (const EntryRun& run : problem.entries) {
    if (run.group != problem.entries.front().group) return chart;
    const EntrySummary s = summarize(run);
    if (run.on_front) front[s.seconds.median] = s.position_distance;
  }
  chart["front"] = front;
  return chart;
}

template <class Value>
Json step_chart(const ProblemComparison& problem, const std::string& id, const std::string& title, const std::string& y,
                Value value) {
  Json series = Json::array();
  for (const EntryRun& run : problem.entries) {
    Json points = Json::array();
    for (const StepTrial& trial : run.trials) {
      points.push_back(
          {{"x", trial.step},
           {"y", value(trial)},
           {"status", trial.false_success() ? std::string("false success") : std::string(to_string(trial.judged))},
           {"label", fmt::format("step {}", trial.step)}});
    }
    series.push_back({{"name", run.label}, {"line", true}, {"points", points}});
  }
  return {{"id", id + "_" + problem.folder},
          {"title", problem.name + ": " + title},
          {"x", {{"label", "step"}}},
          {"y", {{"label", y}, {"log", true}}},
          {"series", series}};
}

/// What became of a step that was never tried, from how its process ended.
std::string outcome_without_trial(const EntryRun& run) {
  if (run.outcome == "time_limit") return "timeout";
  return run.outcome == "interrupted" || run.outcome == "no_states" || run.outcome == "finished" ? "not_applicable"
                                                                                                 : "crash";
}

Json cell_of(const EntryRun& run, int step, const std::string& command) {
  for (const StepTrial& trial : run.trials) {
    if (trial.step != step) continue;
    const bool solved = trial.judged == Status::solved;
    return {{"outcome", solved                  ? "solved"
                        : trial.false_success() ? "false_success"
                                                : "honest_failure"},
            {"text", fmt::format("{}, residual {:.1e}{}{}", to_string(trial.judged), largest_residual(trial.residuals),
                                 trial.result.message.empty() ? "" : ": ", trial.result.message)},
            {"command", command}};
  }
  return {{"outcome", outcome_without_trial(run)},
          {"text", run.outcome + (run.message.empty() ? "" : ": " + run.message)},
          {"command", command}};
}

Json outcome_map(const Comparison& comparison, const ProblemComparison& problem) {
  const auto steps = static_cast<std::size_t>(problem.steps_asked), columns = std::min(steps, most_columns);
  Json map{{"id", "outcomes_" + problem.folder},
           {"title", problem.name + ": what became of each step" + (columns < steps ? ", evenly chosen" : "")},
           {"knob", "step"},
           {"values", Json::array()},
           {"methods", Json::array()},
           {"cells", Json::array()}};
  std::vector<int> chosen;
  for (std::size_t i = 0; i < columns; ++i)
    chosen.push_back(1 + static_cast<int>(columns == 1 ? 0 : i * (steps - 1) / (columns - 1)));
  for (const int step : chosen) map["values"].push_back(std::to_string(step));
  for (const EntryRun& run : problem.entries) {
    const std::string command = command_of(comparison, problem, run);
    Json row = Json::array();
    for (const int step : chosen) row.push_back(cell_of(run, step, command));
    map["methods"].push_back(run.label);
    map["cells"].push_back(row);
  }
  return map;
}

Json entries_table(const ProblemComparison& problem) {
  Json rows = Json::array();
  for (const EntryRun& run : problem.entries) {
    const EntrySummary s = summarize(run);
    const bool tried = !run.trials.empty(), distant = s.distances > 0;
    rows.push_back({run.label, s.solved, run.steps_asked, s.false_successes, status_of(run, s),
                    tried ? Json(s.residual) : Json(), distant ? Json(s.position_distance) : Json(),
                    distant ? Json(s.objective_distance) : Json(), run.on_front ? "*" : "",
                    tried ? Json(s.seconds.median) : Json(), tried ? Json(s.linear_solves) : Json(),
                    static_cast<double>(run.peak_memory_bytes) / 1e6});
  }
  return {
      {"id", "entries_" + problem.folder},
      {"title", problem.name},
      {"columns",
       {"solver", "solved", "of", "false", "status", "residual", "dx", "df", "front", "s/step", "solves/step", "MB"}},
      {"rows", rows}};
}

/// What an entry ended at in a step, where that is a place.
std::optional<Vector> solution_of(const EntryRun& run, const fs::path& folder, int step) {
  const bool has = std::any_of(run.trials.begin(), run.trials.end(),
                               [step](const StepTrial& trial) { return trial.step == step && trial.residuals.finite; });
  return has ? std::optional(read_positions(folder / run.folder, step)) : std::nullopt;
}

/// The reference's solutions, or of entries on their own trajectories those of the first that has any.
Json viewer_of(const ProblemComparison& problem, const fs::path& folder) {
  const EntryRun* shown = &problem.trajectory;
  for (const EntryRun& run : problem.entries) {
    if (shown->trials.empty()) shown = &run;
  }
  if (shown->trials.empty()) return nullptr;
  const Scene scene = read_scene(problem.file, shown->overrides);
  std::vector<ViewerFrame> frames{{0, [&scene] { return frame_of(build_model(scene)->start()); }, problem.file}};
  for (const StepTrial& trial : shown->trials) {
    if (!trial.residuals.finite) continue;  // no place to show
    frames.push_back(
        {trial.step,
         [&folder, shown, step = trial.step] { return frame_of(read_positions(folder / shown->folder, step)); },
         (folder / shown->folder).string()});
  }
  std::vector<OtherPositions> others;
  for (const EntryRun& run : problem.entries) {
    if (&run == shown || run.group != shown->group || others.size() == most_others) continue;
    others.push_back({run.label, [&](int step) { return solution_of(run, folder, step); }});
  }
  Json data = viewer_data(scene, frames, others);
  data["note"] = fmt::format("{} as {} solved it. {}", problem.name, shown->label, data["note"].get<std::string>());
  return data;
}

}  // namespace

Json compare_report(const Comparison& comparison, const std::string& command, const fs::path& folder) {
  Json report{{"title", "Comparison of solvers"}, {"command", command},      {"version", comparison.version},
              {"summary", Json::array()},         {"charts", Json::array()}, {"heat_maps", Json::array()},
              {"tables", Json::array()}};
  report["machine"] = {{"cpu", comparison.machine.cpu},
                       {"cores", comparison.machine.cores},
                       {"threads of a solver", comparison.threads},
                       {"os", comparison.machine.os}};
  for (const ProblemComparison& problem : comparison.problems) {
    for (const EntryRun& run : problem.entries) {
      const EntrySummary s = summarize(run);
      report["summary"].push_back(
          fmt::format("{}, {}: {} of {} steps solved, {} false successes{}.", problem.name, run.label, s.solved,
                      run.steps_asked, s.false_successes,
                      run.trials.empty() ? ", " + run.outcome : fmt::format(", {:.3g} s a step", s.seconds.median)));
      for (const auto& [key, value] : run.overrides) report["settings"][problem.name][run.label][key] = value;
    }
    report["charts"].push_back(error_chart(comparison, problem));
    report["charts"].push_back(time_chart(comparison, problem, "accuracy", "residual against time",
                                          "largest residual of any step",
                                          [](const EntrySummary& summary) { return summary.residual; }));
    report["charts"].push_back(step_chart(problem, "step_seconds", "time of each step", "seconds",
                                          [](const StepTrial& trial) { return spread_of(trial.seconds).median; }));
    report["charts"].push_back(step_chart(problem, "step_residuals", "residual of each step", "largest residual",
                                          [](const StepTrial& trial) { return largest_residual(trial.residuals); }));
    report["heat_maps"].push_back(outcome_map(comparison, problem));
    report["tables"].push_back(entries_table(problem));
  }
  report["summary"].push_back(
      "Residuals are computed from each problem and result without the solver. dx and df: largest distance to the "
      "tightest-converged solution of the step, in positions relative to the scene and in the objective. The Pareto "
      "front is that of seconds a step and dx.");
  if (Json viewer = viewer_of(comparison.problems.front(), folder); !viewer.is_null()) report["viewer"] = viewer;
  return report;
}

}  // namespace taut
