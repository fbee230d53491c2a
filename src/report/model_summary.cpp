#include "report/model_summary.h"

#include <fmt/format.h>

#include <iterator>

namespace taut {
namespace {

using Out = std::back_insert_iterator<std::string>;

void print_residuals(Out out, const RunSummary& s) {
  fmt::format_to(out, "residuals, computed without the solver\n");
  fmt::format_to(out, "  {:<16} {:.2e}  {}\n", "stationarity", s.stationarity.scaled,
                 s.stationarity.unscaled > 0
                     ? fmt::format("{:.2e} of {:.2e}, at {}", s.stationarity.unscaled, s.force_scale, s.worst_node)
                     : "");
  fmt::format_to(out, "  {:<16} {:.2e}  largest violation of a row or bound as written\n", "feasibility",
                 s.feasibility.unscaled);
  fmt::format_to(out, "  {:<16} {:.2e}\n", "complementarity", s.complementarity.scaled);
}

void print_worst(Out out, const RunSummary& s) {
  if (s.status == Status::solved || s.worst_elements.empty()) return;
  fmt::format_to(out, "rows and bounds furthest outside\n");
  for (const WorstElement& worst : s.worst_elements)
    fmt::format_to(out, "  {:.2e}  {}\n", worst.violation, worst.element);
}

}  // namespace

std::string model_summary(const ModelSolution& solution, const std::string& folder) {
  const RunSummary& s = solution.summary;
  std::string text;
  const Out out(text);
  fmt::format_to(out, "{}: {}{}{}\nobjective {:.10g}\n", s.problem, to_string(s.status), s.message.empty() ? "" : ", ",
                 s.message, s.objective);
  print_residuals(out, s);
  print_worst(out, s);
  fmt::format_to(out, "{:.3g} s, {:.3g} s of them in {} for {} Newton systems\n", s.seconds.total,
                 s.seconds.solver.total, s.solver, s.counts.linear_solves);
  for (const std::string& note : s.notes) fmt::format_to(out, "note: {}\n", note);
  if (folder.empty()) {
    fmt::format_to(out, "no files written; --out DIR keeps the result\n");
  } else {
    fmt::format_to(out, "{} files in {}\n", s.files.size(), folder);
  }
  return text;
}

}  // namespace taut
