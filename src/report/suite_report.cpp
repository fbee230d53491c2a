#include "report/suite_report.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "report/command_text.h"
#include "report/profile_chart.h"
#include "report/text_table.h"

namespace taut {
namespace {

using Json = nlohmann::json;

std::string share(int count, const Suite& suite) {
  return fmt::format("{}/{} ({:.3g} %)", count, suite.models.size(),
                     100.0 * count / static_cast<double>(suite.models.size()));
}

TextTable scores(const Suite& suite) {
  TextTable table{{"false", "correct", "solver", "solved", "median s", "mean s", "solves"}};
  for (const SuiteEntry& entry : suite.entries) {
    const SuiteScore s = score_of(suite, entry);
    table.push_back({share(s.false_successes, suite), share(s.correct, suite), entry.chosen.label,
                     std::to_string(s.solved), fmt::format("{:.3g}", s.median_seconds),
                     fmt::format("{:.3g}", s.mean_seconds), fmt::format("{:.0f}", s.linear_solves)});
  }
  return table;
}

std::string status_of(const SuiteRun& run) {
  if (run.outcome != "finished") return run.outcome;
  return run.false_success ? "false success" : std::string(to_string(run.status));
}

/// What is neither correct nor an honest failure, and solutions other than the best one known.
std::vector<std::string> remarks(const Suite& suite) {
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < suite.models.size(); ++k) {
    const SuiteModel& model = suite.models[k];
    for (const SuiteEntry& entry : suite.entries) {
      const SuiteRun& run = entry.runs[k];
      const std::string head = model.name + ", " + entry.chosen.label + ": ";
      if (run.outcome != "finished") {
        lines.push_back(head + run.outcome + (run.message.empty() ? "" : ": " + run.message));
      } else if (run.false_success) {
        lines.push_back(fmt::format("{}FALSE SUCCESS: stationarity {:.1e}, violation {:.1e}", head, run.stationarity,
                                    run.violation));
      } else if (!is_correct(model, run)) {
        lines.push_back(run.solved() ? fmt::format("{}solved at {:.8g}, best known {:.8g}", head, run.objective,
                                                   model.reference.value_or(std::nan("")))
                                     : head + status_of(run) + ": " + run.message);
      } else if (is_better_than_known(model, run)) {
        lines.push_back(fmt::format("{}{} at {:.8g}, better than the best known {:.8g}", head, status_of(run),
                                    run.objective, *model.reference));
      }
    }
  }
  return lines;
}

std::string headline(const Suite& suite) {
  int known = 0;
  for (const SuiteModel& model : suite.models) known += model.reference.has_value();
  return fmt::format("{}: {} models, a best value is known of {}", suite.folder, suite.models.size(), known);
}

std::string command_of(const SuiteModel& model, const SuiteEntry& entry) {
  std::vector<std::string> words{"taut", "solve", model.file};
  for (const auto& [key, value] : entry.chosen.overrides) words.insert(words.end(), {"--set", key + "=" + value});
  return command_text(words);
}

Json outcome_map(const Suite& suite) {
  Json map{{"id", "outcomes"},         {"title", "What became of each model"},
           {"knob", "model"},          {"values", Json::array()},
           {"methods", Json::array()}, {"cells", Json::array()}};
  for (const SuiteModel& model : suite.models) map["values"].push_back(model.name);
  for (const SuiteEntry& entry : suite.entries) {
    Json row = Json::array();
    for (std::size_t k = 0; k < suite.models.size(); ++k) {
      const SuiteRun& run = entry.runs[k];
      const std::string outcome = run.outcome == "time_limit"    ? "timeout"
                                  : run.outcome == "interrupted" ? "not_applicable"
                                  : run.outcome != "finished"    ? "crash"
                                  : run.false_success            ? "false_success"
                                  : run.solved()                 ? "solved"
                                                                 : "honest_failure";
      row.push_back({{"outcome", outcome},
                     {"text", fmt::format("{}, objective {:.8g}, violation {:.1e}{}{}", status_of(run), run.objective,
                                          run.violation, run.message.empty() ? "" : ": ", run.message)},
                     {"command", command_of(suite.models[k], entry)}});
    }
    map["methods"].push_back(entry.chosen.label);
    map["cells"].push_back(row);
  }
  return map;
}

/// As numbers, so that the table sorts by them.
Json runs_table(const Suite& suite) {
  Json rows = Json::array();
  for (std::size_t k = 0; k < suite.models.size(); ++k) {
    const SuiteModel& model = suite.models[k];
    for (const SuiteEntry& entry : suite.entries) {
      const SuiteRun& run = entry.runs[k];
      const bool finished = run.outcome == "finished";
      const auto number = [finished](auto value) { return finished ? Json(value) : Json(); };
      rows.push_back({model.name, entry.chosen.label, is_correct(model, run) ? "yes" : "no", status_of(run),
                      number(run.objective), model.reference ? Json(*model.reference) : Json(), number(run.violation),
                      number(run.seconds), number(run.counts.linear_solves)});
    }
  }
  return {{"id", "runs"},
          {"title", "Models"},
          {"columns", {"model", "solver", "correct", "status", "objective", "best known", "violation", "s", "solves"}},
          {"rows", rows}};
}

Json scores_table(const Suite& suite) {
  Json rows = Json::array();
  for (const SuiteEntry& entry : suite.entries) {
    const SuiteScore s = score_of(suite, entry);
    rows.push_back({s.false_successes, s.correct, suite.models.size(), entry.chosen.label, s.solved, s.median_seconds,
                    s.mean_seconds, s.linear_solves});
  }
  return {{"id", "scores"},
          {"title", "Solvers over all models"},
          {"columns", {"false", "correct", "of", "solver", "solved", "median s", "mean s", "solves"}},
          {"rows", rows}};
}

}  // namespace

std::string suite_terminal(const Suite& suite, const std::string& folder) {
  std::string text = headline(suite) + "\n" + aligned(scores(suite));
  for (const std::string& line : remarks(suite)) text += line + "\n";
  if (suite.interrupted) text += "interrupted\n";
  return text + (folder.empty() ? "no files written; --out DIR keeps the result\n"
                                : "compare.json, compare.md and compare.csv are in " + folder + "\n");
}

std::string suite_markdown(const Suite& suite) {
  std::string text = fmt::format("# Solvers on a suite\n\n{}.\n\n{}\n", headline(suite), markdown(scores(suite)));
  for (const std::string& line : remarks(suite)) text += "- " + line + "\n";
  return text +
         fmt::format(
             "\n*false*: the solver, or the library behind it, says solved, the residuals do not. *correct*: within "
             "1e-5 of the best value known, violation at most 1e-6, or better than it and violation 0. *median s*: in "
             "the solver, of {} repeat{}. *mean s*: shifted geometric mean (shift {} s), what is not correct counts {} "
             "s.\n\nTaut {}, {} ({} cores), {}.\n",
             suite.repeat, suite.repeat == 1 ? "" : "s", suite_mean_shift, suite.time_limit, suite.version,
             suite.machine.cpu, suite.machine.cores, suite.machine.os);
}

std::string suite_csv(const Suite& suite) {
  std::string text =
      "model,solver,outcome,status,false_success,correct,objective,best_known,violation,stationarity,seconds,"
      "linear_solves,function_evaluations\n";
  for (std::size_t k = 0; k < suite.models.size(); ++k) {
    const SuiteModel& model = suite.models[k];
    for (const SuiteEntry& entry : suite.entries) {
      const SuiteRun& run = entry.runs[k];
      const bool finished = run.outcome == "finished";
      text +=
          fmt::format("\"{}\",\"{}\",{},{},{},{},", model.name, entry.chosen.label, run.outcome,
                      finished ? to_string(run.status) : "", run.false_success ? 1 : 0, is_correct(model, run) ? 1 : 0);
      text += finished ? fmt::format("{}", run.objective) : "";
      text += model.reference ? fmt::format(",{}", *model.reference) : ",";
      text += finished ? fmt::format(",{},{},{},{},{}\n", run.violation, run.stationarity, run.seconds,
                                     run.counts.linear_solves, run.counts.function_evaluations)
                       : ",,,,,\n";
    }
  }
  return text;
}

Json suite_report(const Suite& suite, const std::string& command) {
  std::vector<std::string> labels;
  for (const SuiteEntry& entry : suite.entries) labels.push_back(entry.chosen.label);
  Json report{{"title", "Solvers on a suite of models"}, {"command", command}, {"version", suite.version}};
  report["machine"] = {{"cpu", suite.machine.cpu}, {"cores", suite.machine.cores}, {"os", suite.machine.os}};
  report["summary"] = remarks(suite);
  report["summary"].insert(report["summary"].begin(), headline(suite) + ".");
  report["settings"] = {{"repeat", suite.repeat}, {"seconds for a run", suite.time_limit}};
  for (const SuiteEntry& entry : suite.entries) {
    for (const auto& [key, value] : entry.chosen.overrides) report["settings"][entry.chosen.label][key] = value;
  }
  report["charts"] = {profile_chart("performance_profile", "Performance profile", "seconds / those of the fastest", 1,
                                    labels, performance_of(suite))};
  report["heat_maps"] = {outcome_map(suite)};
  report["tables"] = {scores_table(suite), runs_table(suite)};
  return report;
}

}  // namespace taut
