#include "report/chart_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "report/command_text.h"

namespace taut {
namespace {

std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

std::string at_value(const ChartData& chart, const ChartPoint& point) {
  if (point.value.empty()) return point.solver;
  return fmt::format("{} at {} {}", point.solver, chart.knob.name, point.value);
}

std::string reference_words(const ChartReference& reference) {
  std::string text = "reference";
  if (!reference.group.empty()) text += " of " + reference.group;
  text += ": " + reference.text;
  if (reference.kind == "closed form") text = "reference: closed form (" + reference.text + ")";
  if (reference.estimated_error) text += fmt::format("; its own error is about {:.1e}", *reference.estimated_error);
  if (reference.kind == "solution" && !reference.estimated_error) text += "; its own error is not known";
  if (!reference.not_independent_of.empty()) {
    text += fmt::format("; it is no other method than {}, and not independent of it",
                        fmt::join(reference.not_independent_of, ", "));
  }
  return text + ".";
}

/// Below this an error says nothing.
double floor_of(const ProblemChart& problem) {
  double floor = 0;
  for (const ChartReference& reference : problem.references)
    floor = std::max(floor, reference.estimated_error.value_or(0));
  return floor;
}

std::string cheapest_words(const ChartData& chart, const ProblemChart& problem) {
  std::string text;
  const double floor = floor_of(problem);
  for (const double error : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5}) {
    if (error < floor) break;
    const ChartPoint* point = cheapest_below(problem.points, error);
    text += fmt::format("{}under {}: {}", text.empty() ? "cheapest " : "; ", percent(error),
                        point ? fmt::format("{} ({:.3g} s, error {:.1e})", at_value(chart, *point),
                                            point->solver_seconds, *point->error)
                              : "none");
    if (!point) break;
  }
  return text + ".";
}

std::vector<std::string> order_words(const ChartData& chart, const ProblemChart& problem) {
  std::vector<std::string> lines;
  if (chart.knob.kind != KnobKind::step && chart.knob.kind != KnobKind::mesh) return lines;
  for (const std::string& solver : chart.solvers) {
    if (const auto order = order_of(problem.points, solver, floor_of(problem)))
      lines.push_back(fmt::format("observed order of {} in {}: {:.2f}.", solver, chart.knob.name, *order));
  }
  return lines;
}

}  // namespace

TextTable chart_points(const ProblemChart& problem) {
  TextTable table{{"false", "status", "solver", "value", "error", "front", "s", "s in all", "solves", "Gflop", "MB"}};
  for (const ChartPoint& p : problem.points) {
    table.push_back({std::to_string(p.false_successes), p.status, p.solver, p.value,
                     p.error ? fmt::format("{:.2e}", *p.error) : "-", p.on_front ? "*" : "",
                     fmt::format("{:.3g}", p.solver_seconds), fmt::format("{:.3g}", p.seconds),
                     std::to_string(p.counts.linear_solves),
                     p.counts.factor_flops > 0 ? fmt::format("{:.3g}", p.counts.factor_flops / 1e9) : "-",
                     fmt::format("{:.0f}", static_cast<double>(p.peak_memory_bytes) / 1e6)});
  }
  return table;
}

TextTable chart_scores(const ChartData& chart) {
  TextTable table{{"false", "correct", "solver", "solved", "runs", "mean s"}};
  for (const SolverScore& s : scores_of(chart)) {
    const double runs = std::max(s.runs, 1);
    table.push_back({percent(s.false_successes / runs), percent(s.correct / runs), s.solver, percent(s.solved / runs),
                     std::to_string(s.runs), fmt::format("{:.3g}", s.mean_seconds)});
  }
  return table;
}

std::vector<std::string> chart_words(const ChartData& chart, const ProblemChart& problem) {
  std::vector<std::string> lines;
  for (const ChartReference& reference : problem.references) lines.push_back(reference_words(reference));
  lines.push_back(cheapest_words(chart, problem));
  for (const std::string& line : order_words(chart, problem)) lines.push_back(line);
  for (const ChartPoint& point : problem.points) {
    if (point.false_successes > 0) {
      lines.push_back(fmt::format("FALSE SUCCESS: {} says solved in {} steps that are not.", at_value(chart, point),
                                  point.false_successes));
    }
    if (!point.solved() && point.outcome != "interrupted") {
      lines.push_back(fmt::format("{}: {}{}{}", at_value(chart, point), point.status, point.message.empty() ? "" : ": ",
                                  point.message));
    }
  }
  return lines;
}

std::string chart_terminal(const ChartData& chart, const std::string& folder) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (const ProblemChart& problem : chart.problems) {
    fmt::format_to(out, "{}, error in {}\n{}", problem.name, to_string(problem.error), aligned(chart_points(problem)));
    for (const std::string& line : chart_words(chart, problem)) fmt::format_to(out, "{}\n", line);
    fmt::format_to(out, "\n");
  }
  if (chart.problems.size() > 1) {
    fmt::format_to(out,
                   "all problems; correct: solved with an error of at most {}, mean: geometric with a shift of "
                   "{:g} s, anything else counts {:g} s\n{}\n",
                   percent(chart.accuracy), mean_shift, chart.max_seconds, aligned(chart_scores(chart)));
  }
  if (chart.interrupted) fmt::format_to(out, "interrupted; the same command with --resume goes on\n");
  if (folder.empty()) {
    fmt::format_to(out, "no files written; --out DIR keeps charts and data\n");
  } else {
    fmt::format_to(out, "charts (SVG), chart.json, chart.csv and report.json are in {}\n", folder);
  }
  return text;
}

std::string chart_csv(const ChartData& chart) {
  std::string text =
      "problem,solver,knob,value,number,status,outcome,false_successes,error,error_kind,on_front,seconds,"
      "solver_seconds,linear_solves,factorizations,factor_flops,peak_memory_bytes,violation,steps_solved,steps_asked,"
      "command\n";
  for (const ProblemChart& problem : chart.problems) {
    for (const ChartPoint& p : problem.points) {
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                     quoted(problem.name), p.solver, quoted(chart.knob.name), quoted(p.value),
                     std::isfinite(p.number) ? fmt::format("{}", p.number) : "", p.status, quoted(p.outcome),
                     p.false_successes, p.error ? fmt::format("{}", *p.error) : "", to_string(problem.error),
                     p.on_front ? 1 : 0, p.seconds, p.solver_seconds, p.counts.linear_solves, p.counts.factorizations,
                     p.counts.factor_flops, p.peak_memory_bytes, p.violation, p.steps_solved, p.steps_asked,
                     quoted(command_text(p.command)));
    }
  }
  return text;
}

}  // namespace taut
