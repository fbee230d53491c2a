#include "report/run_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "report/viewer_data.h"
#include "study/stored_run.h"

namespace taut {
namespace {

using Json = nlohmann::json;

/// One series of a chart over the steps.
template <class Value>
Json series_of(const std::string& name, const std::vector<StepRecord>& steps, Value value) {
  Json points = Json::array();
  for (const StepRecord& step : steps) {
    points.push_back({{"x", step.step},
                      {"y", value(step)},
                      {"status", to_string(step.status)},
                      {"label", fmt::format("step {}", step.step)}});
  }
  return {{"name", name}, {"line", true}, {"points", points}};
}

Json chart_of(const char* id, const std::string& title, const std::string& y, bool logarithmic, Json series) {
  return {{"id", id},
          {"title", title},
          {"x", {{"label", "step"}}},
          {"y", {{"label", y}, {"log", logarithmic}}},
          {"series", std::move(series)}};
}

/// One series for each of the named numbers of the steps; names are those of the first.
Json named_series(const std::vector<StepRecord>& steps, NamedNumbers StepRecord::*numbers) {
  Json series = Json::array();
  for (const auto& [name, first] : steps.front().*numbers) {
    series.push_back(series_of(name, steps, [&, &name = name](const StepRecord& step) -> Json {
      for (const auto& [other, value] : step.*numbers) {
        if (other == name) return value;
      }
      return nullptr;
    }));
  }
  return series;
}

Json violation_series(const RunSummary& summary, const std::vector<StepRecord>& steps) {
  Json series = Json::array();
  for (const WorstViolation& worst : summary.violations) {
    if (!(worst.max > 0)) continue;
    series.push_back(series_of(worst.constraint, steps, [&](const StepRecord& step) -> Json {
      for (const Violation& violation : step.residuals.violations) {
        if (violation.constraint == worst.constraint) return violation.max;
      }
      return 0;
    }));
  }
  return series;
}

Json charts_of(const StoredRun& run) {
  const std::vector<StepRecord>& steps = run.steps;
  Json charts = Json::array();
  if (steps.empty()) return charts;
  const auto series = [&steps](const std::string& name, auto value) { return series_of(name, steps, value); };
  charts.push_back(
      chart_of("residuals", "Residuals", "relative residual", true,
               {series("stationarity", [](const StepRecord& step) { return step.residuals.stationarity; }),
                series("feasibility", [](const StepRecord& step) { return step.residuals.feasibility; }),
                series("complementarity", [](const StepRecord& step) { return step.residuals.complementarity; })}));
  if (Json violations = violation_series(run.summary, steps); !violations.empty())
    charts.push_back(chart_of("violations", "Largest violation", "in the constraint's own units", true, violations));
  if (Json energies = named_series(steps, &StepRecord::energies); !energies.empty())
    charts.push_back(chart_of("energies", "Energies", "energy, J", false, energies));
  charts.push_back(chart_of("seconds", "Time of the solver", "seconds", false,
                            {series("solver", [](const StepRecord& step) { return step.seconds.total; }),
                             series("factorisation", [](const StepRecord& step) { return step.seconds.factorization; }),
                             series("assembly", [](const StepRecord& step) { return step.seconds.assembly; })}));
  charts.push_back(
      chart_of("newton_systems", "Newton systems", "systems solved", false,
               {series("Newton systems", [](const StepRecord& step) { return step.counts.linear_solves; })}));
  if (Json probes = named_series(steps, &StepRecord::probes); !probes.empty())
    charts.push_back(chart_of("probes", "Probes", "value, in its own unit", false, probes));
  return charts;
}

Json violations_table(const RunSummary& s) {
  Json rows = Json::array();
  for (const WorstViolation& worst : s.violations)
    rows.push_back({worst.constraint, worst.max, worst.where, worst.step > 0 ? Json(worst.step) : Json()});
  return {{"id", "violations"},
          {"title", "Largest violation of each constraint"},
          {"columns", {"constraint", "violation", "where", "step"}},
          {"rows", rows}};
}

Json worst_table(const RunSummary& s) {
  Json rows = Json::array();
  for (const WorstElement& worst : s.worst_elements) rows.push_back({worst.constraint, worst.element, worst.violation});
  return {{"id", "worst_elements"},
          {"title", fmt::format("Elements furthest outside in step {}", s.worst_elements_step)},
          {"columns", {"constraint", "element", "violation"}},
          {"rows", rows}};
}

Json probes_table(const RunSummary& s) {
  Json rows = Json::array();
  for (const ProbeValue& probe : s.probes) {
    const auto& expected = probe.expected;
    rows.push_back({probe.name, probe.value, expected ? Json(expected->value) : Json(),
                    expected ? Json(probe.allowed()) : Json(), expected ? probe.within() ? "within" : "outside" : "",
                    expected ? expected->source : ""});
  }
  return {{"id", "probes"},
          {"title", "Probes after the last step"},
          {"columns", {"probe", "value", "expected", "allowed difference", "verdict", "source"}},
          {"rows", rows}};
}

Json steps_table(const std::vector<StepRecord>& steps) {
  Json rows = Json::array();
  for (const StepRecord& step : steps) {
    const Residuals& r = step.residuals;
    rows.push_back({step.step, step.time, to_string(step.status), r.stationarity, r.feasibility, r.complementarity,
                    step.counts.linear_solves, step.seconds.total, step.message});
  }
  return {{"id", "steps"},
          {"title", "Steps"},
          {"columns",
           {"step", "time", "status", "stationarity", "feasibility", "complementarity", "Newton systems", "seconds",
            "message"}},
          {"rows", rows}};
}

Json summary_of(const StoredRun& run) {
  const RunSummary& s = run.summary;
  Json lines = Json::array();
  if (!run.scene.description.empty()) lines.push_back(run.scene.description);
  if (!run.scene.look_for.empty()) lines.push_back("Look for: " + run.scene.look_for);
  lines.push_back(fmt::format("{}: {} of {} steps solved{}{}", to_string(s.status), s.steps_solved, s.steps_asked,
                              s.message.empty() ? "." : ": ", s.message));
  lines.push_back(
      fmt::format("Largest residuals of any step, computed without the solver: stationarity {:.1e}, feasibility "
                  "{:.1e}, complementarity {:.1e}.",
                  s.stationarity.scaled, s.feasibility.scaled, s.complementarity.scaled));
  for (const WorstViolation& worst : s.violations) {
    if (worst.max > 0)
      lines.push_back(fmt::format("{} is violated most at {} in step {}, by {:.2e}.", worst.constraint, worst.where,
                                  worst.step, worst.max));
  }
  lines.push_back(fmt::format("{:.3g} s in all, of which {} took {:.3g} s for {} Newton systems.", s.seconds.total,
                              s.solver, s.seconds.solver.total, s.counts.linear_solves));
  for (const std::string& note : s.notes) lines.push_back("Note: " + note);
  return lines;
}

}  // namespace

Json run_report(const std::filesystem::path& folder, const std::string& command) {
  const StoredRun run = read_stored_run(folder);
  const RunSummary& s = run.summary;
  Json report{{"title", s.problem}, {"command", command}, {"version", s.version}};
  report["machine"] = {{"cpu", s.machine.cpu},
                       {"cores", s.machine.cores},
                       {"threads", s.threads},
                       {"os", s.machine.os},
                       {"peak memory, MB", s.peak_memory_bytes / 1'000'000}};
  report["summary"] = summary_of(run);
  report["settings"] = Json::parse(run.scene.document);
  report["charts"] = charts_of(run);
  report["tables"] = Json::array();
  if (!s.violations.empty()) report["tables"].push_back(violations_table(s));
  if (s.status != Status::solved && !s.worst_elements.empty()) report["tables"].push_back(worst_table(s));
  if (!s.probes.empty()) report["tables"].push_back(probes_table(s));
  report["tables"].push_back(steps_table(run.steps));
  if (Json viewer = viewer_data(folder, run.scene); !viewer.is_null()) report["viewer"] = std::move(viewer);
  return report;
}

}  // namespace taut
