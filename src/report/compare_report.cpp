#include "report/compare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "report/command_text.h"
#include "study/solver_entries.h"

namespace taut {
namespace {

using Json = nlohmann::json;

constexpr std::size_t most_columns = 40;  // of a heat map

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

/// Cost and accuracy of the entries, a series for each solver.
Json accuracy_chart(const Comparison& comparison, const ProblemComparison& problem) {
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
                                 {"y", summary.residual},
                                 {"status", status_of(run, summary)},
                                 {"label", run.label},
                                 {"command", command_of(comparison, problem, run)}});
  }
  return {{"id", "accuracy_" + problem.folder},
          {"title", problem.name + ": accuracy against time"},
          {"x", {{"label", "seconds a step"}, {"log", true}}},
          {"y", {{"label", "largest residual of any step"}, {"log", true}}},
          {"series", series}};
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
                    distant ? Json(s.objective_distance) : Json(), tried ? Json(s.seconds.median) : Json(),
                    tried ? Json(s.linear_solves) : Json(), static_cast<double>(run.peak_memory_bytes) / 1e6});
  }
  return {
      {"id", "entries_" + problem.folder},
      {"title", problem.name},
      {"columns", {"solver", "solved", "of", "false", "status", "residual", "dx", "df", "s/step", "solves/step", "MB"}},
      {"rows", rows}};
}

}  // namespace

Json compare_report(const Comparison& comparison, const std::string& command) {
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
    report["charts"].push_back(accuracy_chart(comparison, problem));
    report["charts"].push_back(step_chart(problem, "step_seconds", "time of each step", "seconds",
                                          [](const StepTrial& trial) { return spread_of(trial.seconds).median; }));
    report["charts"].push_back(step_chart(problem, "step_residuals", "residual of each step", "largest residual",
                                          [](const StepTrial& trial) { return largest_residual(trial.residuals); }));
    report["heat_maps"].push_back(outcome_map(comparison, problem));
    report["tables"].push_back(entries_table(problem));
  }
  report["summary"].push_back(
      "Residuals are computed from each problem and result without the solver. dx and df: largest distance to the "
      "tightest-converged solution of the step, in positions relative to the scene and in the objective.");
  return report;
}

}  // namespace taut
