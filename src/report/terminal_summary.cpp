#include "report/terminal_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace taut {
namespace {

using Out = std::back_insert_iterator<std::string>;

void print_residuals(Out out, const RunSummary& s) {
  const auto print = [&](const char* name, const Worst& worst, const std::string& where) {
    fmt::format_to(out, "  {:<16} {:.2e}  {}\n", name, worst.scaled,
                   worst.step > 0 ? fmt::format("step {}{}", worst.step, where) : "");
  };
  fmt::format_to(out, "worst residuals (relative)\n");
  print("stationarity", s.stationarity,
        fmt::format(", {}, {:.2e} of {:.2e} N", s.worst_node, s.stationarity.unscaled, s.force_scale));
  print("feasibility", s.feasibility, "");
  print("complementarity", s.complementarity, "");
}

void print_violations(Out out, const RunSummary& s) {
  if (s.violations.empty()) return;
  fmt::format_to(out, "worst violations\n");
  for (const WorstViolation& v : s.violations) {
    fmt::format_to(out, "  {:<16} {:.2e}  {}\n", v.constraint, v.max,
                   v.step > 0 ? fmt::format("step {}, {}", v.step, v.where) : "");
    if (!v.penetration) continue;
    fmt::format_to(out, "  {:<16} between its vertices, edges are up to {:.2e} m and faces {:.2e} m inside\n", "",
                   v.penetration->edge, v.penetration->face);
  }
}

void print_worst_elements(Out out, const RunSummary& s) {
  if (s.status == Status::solved || s.worst_elements.empty()) return;
  fmt::format_to(out, "worst elements of step {}\n", s.worst_elements_step);
  for (const WorstElement& worst : s.worst_elements) {
    fmt::format_to(out, "  {:<16} {:.2e}  {}\n", worst.constraint, worst.violation, worst.element);
  }
}

void print_probes(Out out, const RunSummary& s) {
  if (s.probes.empty()) return;
  fmt::format_to(out, "probes\n");
  for (const ProbeValue& probe : s.probes) {
    fmt::format_to(out, "  {:<16} {:.6g}", probe.name, probe.value);
    if (probe.expected) {
      fmt::format_to(out, "  {} {:.6g} within {:.2g} ({})", probe.within() ? "is" : "is not", probe.expected->value,
                     probe.allowed(), probe.expected->source);
    }
    fmt::format_to(out, "\n");
  }
}

void print_seconds(Out out, const RunSummary& s) {
  const RunSeconds& t = s.seconds;
  const double step = t.solver.total / std::max(1, s.steps_done);
  fmt::format_to(out,
                 "{:.3g} s, {:.3g} s a step in the solver ({} Newton systems; factorisation {:.3g} s, solve {:.3g} s, "
                 "assembly {:.3g} s), judging {:.3g} s, output {:.3g} s\n",
                 t.total, step, s.counts.linear_solves, t.solver.factorization, t.solver.solve, t.solver.assembly,
                 t.judging, t.output);
}

}  // namespace

std::string terminal_summary(const RunSummary& s, const std::string& folder) {
  std::string text;
  const Out out(text);
  fmt::format_to(out, "{}: {}, {} of {} steps solved", s.problem, to_string(s.status), s.steps_solved, s.steps_asked);
  if (s.steps_done > s.steps_solved) fmt::format_to(out, ", {} not", s.steps_done - s.steps_solved);
  fmt::format_to(out, "\n");
  if (!s.message.empty()) fmt::format_to(out, "{}\n", s.message);
  if (s.steps_done > 0) {
    print_residuals(out, s);
    print_violations(out, s);
  }
  print_worst_elements(out, s);
  print_probes(out, s);
  print_seconds(out, s);
  for (const std::string& note : s.notes) fmt::format_to(out, "note: {}\n", note);
  if (folder.empty()) {
    fmt::format_to(out, "no files written; --out DIR keeps the result\n");
  } else {
    fmt::format_to(out, "{} files in {}\n", s.files.size(), folder);
  }
  const bool resumable = s.status == Status::interrupted || s.status == Status::time_limit;
  if (resumable && !folder.empty()) fmt::format_to(out, "the same command with --resume goes on\n");
  return text;
}

}  // namespace taut
