#include "report/lean_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "report/command_text.h"
#include "report/text_table.h"
#include "study/pareto.h"

namespace taut {
namespace {

using Json = nlohmann::json;

bool relative(const LeanStudy& study) { return study.tolerance.relative && study.outcome.magnitude > 0; }

/// "0.8 %" of the magnitude, or in the unit of the quantity.
std::string error_text(const LeanStudy& study, double error) {
  if (!std::isfinite(error)) return "-";
  if (relative(study)) return fmt::format("{:.2g} %", 100 * error / study.outcome.magnitude);
  const std::string unit = study.quantity.unit();
  return fmt::format("{:.2g}{}", error, unit.empty() ? "" : " " + unit);
}

std::string error_text(const LeanStudy& study, const std::optional<double>& error) {
  return error ? error_text(study, *error) : "-";
}

std::string seconds_text(double seconds) { return fmt::format("{:.2g} s", seconds); }

/// By how much a model is wrong, as well as it is known.
std::optional<double> known_error(const LeanRung& rung) { return rung.verified ? rung.verified : rung.estimated; }

std::string answer_text(const LeanStudy& study, const Answer& answer) {
  const bool one = answer.values.size() == 1;
  return fmt::format("{:.5g} {}", one ? answer.values[0] : answer.magnitude, study.quantity.unit());
}

std::string mark_of(const LeanOutcome& outcome, std::size_t k) {
  if (outcome.lean == k) return "lean";
  if (outcome.full == k) return "full";
  return outcome.above == k ? "above" : "";
}

TextTable rung_table(const LeanStudy& study) {
  TextTable table{{"", "model", study.quantity.kind == QuantityOfInterest::Kind::shape ? "moved" : "answer",
                   "estimated", "verified", "true", "s", "solves"}};
  for (std::size_t k = 0; k < study.outcome.rungs.size(); ++k) {
    const LeanRung& rung = study.outcome.rungs[k];
    table.push_back({mark_of(study.outcome, k), rung.words,
                     rung.answer ? answer_text(study, *rung.answer) : rung.status, error_text(study, rung.estimated),
                     error_text(study, rung.verified), error_text(study, rung.true_error),
                     fmt::format("{:.2f}", rung.seconds), std::to_string(rung.linear_solves)});
    for (const ResidualTrial& trial : study.outcome.residual_trials) {
      if (trial.from != k) continue;
      table.push_back({"residual", trial.words + ", not run",
                       trial.answer ? answer_text(study, *trial.answer) : "not trusted", "-", "-", "-",
                       fmt::format("{:.2f}", trial.seconds), std::to_string(trial.linear_solves)});
    }
  }
  if (study.known_seconds) return table;
  const auto column = std::find(table[0].begin(), table[0].end(), "true") - table[0].begin();
  for (auto& row : table) row.erase(row.begin() + column);
  return table;
}

TextTable omission_table(const LeanStudy& study) {
  TextTable table{{"tried", "changes the answer by", "", "why"}};
  for (const OmissionTrial& trial : study.outcome.omissions)
    table.push_back({trial.what, error_text(study, trial.change), trial.left_out ? "left out" : "kept", trial.why});
  for (const ResidualTrial& trial : study.outcome.residual_trials)
    if (!trial.answer) table.push_back({"residual of " + trial.words, "-", "not trusted", trial.why});
  for (const NotApplicable& one : study.ladder.not_applicable)
    table.push_back({one.name, "-", "not tried", one.reason});
  return table;
}

std::string full_text(const LeanStudy& study) {
  return fmt::format("the full scene takes {} ({})", seconds_text(study.outcome.predicted_full_seconds),
                     study.outcome.full ? "measured" : "predicted");
}

std::string headline(const LeanStudy& study) {
  const LeanOutcome& outcome = study.outcome;
  if (!outcome.lean) {
    if (outcome.full) return "No model: the full scene is not solved: " + outcome.rungs[*outcome.full].message;
    return "No model was found before the search ended.";
  }
  const LeanRung& rung = outcome.rungs[*outcome.lean];
  if (outcome.lean == outcome.full)
    return fmt::format("No simpler model answers {} to {}; {}.", study.quantity.text(),
                       error_text(study, outcome.allowed), full_text(study));
  const std::optional<double> error = known_error(rung);
  return fmt::format("{} answers {} to {} in {}; {}.", rung.words, study.quantity.text(), error_text(study, error),
                     seconds_text(rung.seconds), full_text(study));
}

std::string verification(const LeanStudy& study) {
  const LeanOutcome& outcome = study.outcome;
  switch (outcome.end) {
    case LeanEnd::verified:
      return fmt::format(
          "Verified against {}: the difference, with what that model lacks by the estimate, is within {}. The full "
          "scene was not run.",
          outcome.rungs[*outcome.above].words, error_text(study, outcome.allowed));
    case LeanEnd::exact:
      return "No cheap model could be verified by another one, so the full scene was run; errors are differences to "
             "it.";
    case LeanEnd::over_budget:
      return "NOT VERIFIED: the time was over; this is the model with the smallest estimate so far.";
    case LeanEnd::interrupted:
      return "NOT VERIFIED: interrupted; this is the model with the smallest estimate so far.";
    case LeanEnd::not_solved:
      break;
  }
  return "Nothing can be compared with a full scene that is not solved.";
}

}  // namespace

std::vector<std::string> lean_words(const LeanStudy& study) {
  std::vector<std::string> words{headline(study), verification(study)};
  const std::string search =
      fmt::format("The search took {} in {} models", seconds_text(study.seconds), study.outcome.rungs.size());
  if (study.costs_more_than_full())
    words.push_back(search + ", MORE than the full scene: it pays only where the model is used again.");
  else
    words.push_back(fmt::format("{}, {:.0f} % of the full scene.", search,
                                100 * study.seconds / study.outcome.predicted_full_seconds));
  return words;
}

std::string lean_terminal(const LeanStudy& study, const std::string& folder) {
  std::string text =
      fmt::format("{}: {} within {}\n", study.problem, study.quantity.text(), error_text(study, study.outcome.allowed));
  for (const std::string& line : lean_words(study)) text += line + "\n";
  text += "\n" + aligned(rung_table(study)) + "\n" + aligned(omission_table(study));
  if (!folder.empty() && !study.file.empty()) text += fmt::format("\n{}/{} runs it\n", folder, study.file);
  return text;
}

Json lean_report(const LeanStudy& study, const std::string& command) {
  const LeanOutcome& outcome = study.outcome;
  const double unit = relative(study) ? outcome.magnitude : 1;
  Json points = Json::array();
  std::vector<WorkPrecision> work;
  for (std::size_t k = 0; k < outcome.rungs.size(); ++k) {
    const LeanRung& rung = outcome.rungs[k];
    const std::optional<double> error = known_error(rung);
    const bool known = rung.answer && error && std::isfinite(*error) && *error > 0;
    const std::string mark = mark_of(outcome, k);
    points.push_back({{"x", rung.seconds},
                      {"y", known ? Json(*error / unit) : Json()},
                      {"status", rung.status},
                      {"label", (mark.empty() ? "" : mark + ": ") + rung.words},
                      {"command", command_text(rung.command)}});
    work.push_back({rung.seconds, known ? *error / unit : std::nan("")});
  }
  Json front = Json::array();
  for (const std::size_t k : pareto_front(work)) front.push_back({work[k].cost, work[k].error});
  const std::string label = relative(study) ? "error, relative" : "error, " + study.quantity.unit();
  const auto table_json = [](const std::string& id, const std::string& title, const TextTable& table) {
    return Json{{"id", id},
                {"title", title},
                {"columns", table.front()},
                {"rows", std::vector<std::vector<std::string>>(table.begin() + 1, table.end())}};
  };
  return {{"title", "The leanest model of " + study.problem},
          {"command", command},
          {"version", study.version},
          {"machine",
           {{"cpu", study.machine.cpu},
            {"cores", study.machine.cores},
            {"threads of a solver", study.threads},
            {"os", study.machine.os}}},
          {"settings",
           {{"quantity", study.quantity.text()},
            {"allowed error", error_text(study, outcome.allowed)},
            {"safety factor on estimates", lean_safety}}},
          {"summary", lean_words(study)},
          {"charts",
           {{{"id", "pareto"},
             {"title", "Error of " + study.quantity.text() + " against seconds"},
             {"x", {{"label", "seconds"}, {"log", true}}},
             {"y", {{"label", label}, {"log", true}}},
             {"series", {{{"name", "models"}, {"line", false}, {"points", points}}}},
             {"front", front}}}},
          {"tables",
           {table_json("models", "Models", rung_table(study)),
            table_json("left_out", "What was left out", omission_table(study))}}};
}

std::string lean_check_terminal(const LeanStudy& study) {
  const LeanOutcome& outcome = study.outcome;
  if (!outcome.full) return fmt::format("{}: the scene is not solved: {}\n", study.problem, outcome.rungs[0].message);
  std::string text = fmt::format("{}: what could go, {} changing by at most {}\n", study.problem, study.quantity.text(),
                                 error_text(study, outcome.allowed));
  TextTable table{{"", "change", "s", ""}};
  for (std::size_t k = 0; k < outcome.omissions.size(); ++k) {
    const OmissionTrial& trial = outcome.omissions[k];
    table.push_back({trial.what, error_text(study, trial.change), fmt::format("{:.2f}", outcome.rungs[k + 1].seconds),
                     trial.left_out ? "could go" : trial.why});
  }
  text += aligned(table) + fmt::format("as written: {:.2f} s\n", outcome.rungs[0].seconds);
  const auto could_go = std::count_if(outcome.omissions.begin(), outcome.omissions.end(),
                                      [](const OmissionTrial& trial) { return trial.left_out; });
  if (outcome.end == LeanEnd::over_budget) text += "The time was over before everything was tried.\n";
  return text + (could_go == 0 ? "Nothing could go.\n"
                               : fmt::format("{} could go, each alone; several together were not tried.\n", could_go));
}

}  // namespace taut
