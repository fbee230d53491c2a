#include "report/model_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace taut {
namespace {

using Json = nlohmann::json;

constexpr int most_lines = 1000;  // of a table

Json finite_or_none(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json residuals_table(const RunSummary& s) {
  return {{"id", "residuals"},
          {"title", "Residuals, computed without the solver"},
          {"columns", {"residual", "relative", "as it is"}},
          {"rows",
           {{"stationarity", s.stationarity.scaled, s.stationarity.unscaled},
            {"feasibility", s.feasibility.scaled, s.feasibility.unscaled},
            {"complementarity", s.complementarity.scaled, s.complementarity.unscaled}}}};
}

Json worst_table(const RunSummary& s) {
  Json rows = Json::array();
  for (const WorstElement& worst : s.worst_elements) rows.push_back({worst.element, worst.violation});
  return {{"id", "worst_rows"},
          {"title", "Rows and bounds furthest outside"},
          {"columns", {"row or bound", "violation"}},
          {"rows", rows}};
}

Json variables_table(const NlModel& model, const ModelSolution& solution) {
  Json rows = Json::array();
  for (int i = 0; i < std::min(model.variables(), most_lines); ++i)
    rows.push_back({model.variable_name(i), finite_or_none(model.lower()[i]), finite_or_none(solution.x[i]),
                    finite_or_none(model.upper()[i])});
  return {{"id", "variables"},
          {"title", "Variables"},
          {"columns", {"variable", "lower bound", "value", "upper bound"}},
          {"rows", rows}};
}

Json rows_table(const NlModel& model, const ModelSolution& solution) {
  Json rows = Json::array();
  for (int row = 0; row < std::min(model.rows(), most_lines); ++row)
    rows.push_back({model.row_name(row), finite_or_none(model.row_lower()[row]),
                    finite_or_none(model.value_at(row, solution.x)), finite_or_none(model.row_upper()[row]),
                    finite_or_none(solution.dual[row])});
  return {{"id", "rows"},
          {"title", "Rows"},
          {"columns", {"row", "lower bound", "value", "upper bound", "multiplier"}},
          {"rows", rows}};
}

}  // namespace

Json model_report(const NlModel& model, const ModelSolution& solution, const Scene& settings,
                  const std::string& command) {
  const RunSummary& s = solution.summary;
  Json report{{"title", s.problem}, {"command", command}, {"version", s.version}};
  report["machine"] = {{"cpu", s.machine.cpu}, {"cores", s.machine.cores}, {"os", s.machine.os}};
  report["summary"] = {
      fmt::format("{} variables, {} rows, {}.", model.variables(), model.rows(),
                  !model.has_objective() ? "no objective"
                  : model.maximise()     ? "maximised"
                                         : "minimised"),
      fmt::format("{}{}{}; objective {:.10g}.", to_string(s.status), s.message.empty() ? "" : ": ", s.message,
                  s.objective),
      fmt::format("{:.3g} s of {} for {} linear systems.", s.seconds.solver.total, s.solver, s.counts.linear_solves)};
  if (solution.false_success)
    report["summary"].push_back("The solver claims success, which the residuals do not call solved.");
  report["settings"] = Json::parse(settings.document);
  report["tables"] = {residuals_table(s)};
  if (!s.worst_elements.empty()) report["tables"].push_back(worst_table(s));
  if (model.variables() > 0) report["tables"].push_back(variables_table(model, solution));
  if (model.rows() > 0) report["tables"].push_back(rows_table(model, solution));
  report["charts"] = Json::array();
  return report;
}

}  // namespace taut
