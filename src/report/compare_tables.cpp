#include "report/compare_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <vector>

#include "report/text_table.h"

namespace taut {
namespace {

using Row = std::vector<std::string>;

std::string failures_of(const EntrySummary& summary) {
  std::string text;
  for (const auto& [kind, count] : summary.failures)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", kind, count);
  return text.empty() ? "-" : text;
}

std::string seconds_of(const EntryRun& run, const EntrySummary& summary) {
  const Spread& s = summary.seconds;
  if (run.trials.empty()) return "-";
  return s.min == s.max ? fmt::format("{:.3g}", s.median)
                        : fmt::format("{:.3g} ({:.3g}..{:.3g})", s.median, s.min, s.max);
}

Row row_of(const EntryRun& run) {
  const EntrySummary s = summarize(run);
  const auto number = [&run](double value) { return run.trials.empty() ? "-" : fmt::format("{:.1e}", value); };
  const auto distance = [&s](double value) { return s.distances == 0 ? "-" : fmt::format("{:.1e}", value); };
  return {run.label,
          fmt::format("{}/{}", s.solved, run.steps_asked),
          std::to_string(s.false_successes),
          failures_of(s),
          number(s.residual),
          distance(s.position_distance),
          distance(s.objective_distance),
          run.on_front ? "*" : "",
          seconds_of(run, s),
          run.trials.empty() ? "-" : fmt::format("{:.1f}", s.linear_solves),
          fmt::format("{:.0f}", static_cast<double>(run.peak_memory_bytes) / 1e6)};
}

TextTable table_of(const ProblemComparison& problem) {
  TextTable table{
      {"solver", "solved", "false", "failures", "residual", "dx", "df", "front", "s/step", "solves/step", "MB"}};
  for (const EntryRun& run : problem.entries) table.push_back(row_of(run));
  return table;
}

std::string headline(const ProblemComparison& problem, const Comparison& comparison) {
  if (comparison.free)
    return fmt::format("{}: {} steps, each entry on its own trajectory", problem.name, problem.steps_asked);
  const EntryRun& trajectory = problem.trajectory;
  std::string text =
      fmt::format("{}: {} steps from the states of {}", problem.name, problem.steps_asked, trajectory.label);
  if (problem.trajectory_solved) return text;
  const EntrySummary s = summarize(trajectory);
  text += fmt::format(", which solved only {}: {}", s.solved, failures_of(s));
  return trajectory.message.empty() ? text : text + " (" + trajectory.message + ")";
}

/// The entries on the front, every false success, and every entry that did not finish with the last that it said.
Row remarks(const ProblemComparison& problem) {
  Row lines, front;
  for (const EntryRun& run : problem.entries) {
    if (run.on_front) front.push_back(run.label);
  }
  if (!front.empty()) lines.push_back(fmt::format("Pareto front of s/step against dx: {}", fmt::join(front, "; ")));
  for (const EntryRun& run : problem.entries) {
    if (run.outcome != "finished") {
      lines.push_back(fmt::format("{}: {}{}{}", run.label, run.outcome, run.message.empty() ? "" : ": ", run.message));
    }
    for (const StepTrial& trial : run.trials) {
      if (!trial.false_success()) continue;
      const Residuals& r = trial.residuals;
      lines.push_back(
          fmt::format("{}: FALSE SUCCESS in step {}: stationarity {:.1e}, feasibility {:.1e}, complementarity {:.1e}",
                      run.label, trial.step, r.stationarity, r.feasibility, r.complementarity));
    }
  }
  return lines;
}

std::string worst_violation(const Residuals& residuals) {
  std::string text;
  for (const Violation& v : residuals.violations) {
    if (v.max > 0) text += fmt::format("{}{}: {:.3e} at {}", text.empty() ? "" : "; ", v.constraint, v.max, v.where);
  }
  return text;
}

void csv_line(std::back_insert_iterator<std::string> out, const ProblemComparison& problem, const EntryRun& run,
              const StepTrial& trial) {
  const Residuals& r = trial.residuals;
  const Counts& c = trial.result.counts;
  const Timings& t = trial.result.timings;
  const Spread seconds = spread_of(trial.seconds);
  fmt::format_to(out, "{},{},{},{},{},{},{}", quoted(problem.name), quoted(run.label), trial.step,
                 to_string(trial.result.status), to_string(trial.judged), trial.false_success() ? 1 : 0,
                 trial.objective);
  fmt::format_to(out, ",{},{},{},{},{},{}", r.stationarity, r.stationarity_unscaled, r.feasibility,
                 r.feasibility_unscaled, r.complementarity, r.complementarity_unscaled);
  if (trial.distance) {
    fmt::format_to(out, ",{},{},{}", trial.distance->positions, trial.distance->objective,
                   quoted(trial.distance->reference));
  } else {
    fmt::format_to(out, ",,,");
  }
  fmt::format_to(out, ",{},{},{},{}", c.outer, c.linear_solves, c.factorizations, c.function_evaluations);
  fmt::format_to(out, ",{},{},{},{},{},{},{}", seconds.median, seconds.min, seconds.max, t.assembly, t.analysis,
                 t.factorization, t.solve);
  fmt::format_to(out, ",{},{},{}\n", trial.peak_memory_bytes, trial.warm_start, quoted(worst_violation(r)));
}

}  // namespace

std::string compare_terminal(const Comparison& comparison, const std::string& folder) {
  std::string text;
  const auto out = std::back_inserter(text);
  for (const ProblemComparison& problem : comparison.problems) {
    fmt::format_to(out, "{}\n{}", headline(problem, comparison), aligned(table_of(problem)));
    for (const std::string& line : remarks(problem)) fmt::format_to(out, "{}\n", line);
    fmt::format_to(out, "\n");
  }
  if (comparison.interrupted) {
    fmt::format_to(out, "interrupted{}\n", folder.empty() ? "" : "; the same command with --resume goes on");
  }
  if (folder.empty()) {
    fmt::format_to(out, "no files written; --out DIR keeps the result\n");
  } else {
    fmt::format_to(out, "compare.json, compare.md and compare.csv are in {}\n", folder);
  }
  return text;
}

std::string compare_markdown(const Comparison& comparison) {
  std::string text = "# Comparison of solvers\n";
  const auto out = std::back_inserter(text);
  for (const ProblemComparison& problem : comparison.problems) {
    fmt::format_to(out, "\n## {}\n\n{}.\n\n{}", problem.name, headline(problem, comparison),
                   markdown(table_of(problem)));
    const Row lines = remarks(problem);
    if (!lines.empty()) fmt::format_to(out, "\n");
    for (const std::string& line : lines) fmt::format_to(out, "- {}\n", line);
  }
  fmt::format_to(
      out,
      "\n*solved*: steps whose independent residuals are within the entry's tolerance. *false*: steps that the "
      "solver called solved and the residuals do not. *residual*: the largest scaled one. *dx*, *df*: largest "
      "distance to the tightest-converged solution of the step, in positions relative to the size of the scene "
      "and in the objective. *front*: of the entries that solved every step, those that no other beats in both s/step "
      "and dx. *s/step*: mean over the steps, median (and range) over {} repeat{}. *MB*: peak of "
      "the process.\n",
      comparison.repeat, comparison.repeat == 1 ? "" : "s");
  fmt::format_to(out, "\nTaut {}, {} ({} cores), {}; {} thread{} per solver.\n", comparison.version,
                 comparison.machine.cpu, comparison.machine.cores, comparison.machine.os, comparison.threads,
                 comparison.threads == 1 ? "" : "s");
  return text;
}

std::string compare_csv(const Comparison& comparison) {
  std::string text =
      "problem,solver,step,claimed,judged,false_success,objective,stationarity,stationarity_unscaled,feasibility,"
      "feasibility_unscaled,complementarity,complementarity_unscaled,position_distance,objective_distance,reference,"
      "outer,linear_solves,factorizations,function_evaluations,seconds_median,seconds_min,seconds_max,"
      "seconds_assembly,seconds_analysis,seconds_factorization,seconds_solve,peak_memory_bytes,warm_start,"
      "violations\n";
  for (const ProblemComparison& problem : comparison.problems) {
    for (const EntryRun& run : problem.entries) {
      for (const StepTrial& trial : run.trials) csv_line(std::back_inserter(text), problem, run, trial);
    }
  }
  return text;
}

}  // namespace taut
