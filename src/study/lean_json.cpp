#include <cmath>
#include <nlohmann/json.hpp>

#include "study/lean.h"

namespace taut {
namespace {

using Json = nlohmann::ordered_json;
constexpr int format_version = 1;

Json number_or_null(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json();
}

Json rung_json(const LeanRung& rung, const LeanLadder& ladder) {
  Json json{{"name", rung.name}, {"what", rung.words}, {"levels", Json::object()}, {"status", rung.status}};
  for (std::size_t k = 0; k < rung.levels.size(); ++k) json["levels"][ladder.simplifications[k].name] = rung.levels[k];
  json["message"] = rung.message;
  json["answer"] = rung.answer && rung.answer->values.size() == 1 ? Json(rung.answer->values[0]) : Json();
  json["magnitude"] = rung.answer ? Json(rung.answer->magnitude) : Json();
  json["estimated_error"] = number_or_null(rung.estimated);
  json["verified_error"] = number_or_null(rung.verified);
  json["true_error"] = number_or_null(rung.true_error);
  json["seconds"] = rung.seconds;
  json["linear_solves"] = rung.linear_solves;
  json["peak_memory_bytes"] = rung.peak_memory_bytes;
  json["command"] = rung.command;
  return json;
}

Json trial_json(const ResidualTrial& trial, const LeanOutcome& outcome) {
  return {{"name", trial.name},
          {"from", outcome.rungs[trial.from].name},
          {"what", trial.words},
          {"change", number_or_null(trial.change)},
          {"trusted", trial.answer.has_value()},
          {"why", trial.why},
          {"seconds", trial.seconds},
          {"linear_solves", trial.linear_solves}};
}

const char* end_word(LeanEnd end) {
  switch (end) {
    case LeanEnd::verified:
      return "verified";
    case LeanEnd::exact:
      return "exact";
    case LeanEnd::over_budget:
      return "over_budget";
    case LeanEnd::interrupted:
      return "interrupted";
    case LeanEnd::not_solved:
      break;
  }
  return "not_solved";
}

Json name_or_null(const LeanOutcome& outcome, const std::optional<std::size_t>& place) {
  return place ? Json(outcome.rungs[*place].name) : Json();
}

}  // namespace

std::string lean_text(const LeanStudy& study) {
  const LeanOutcome& outcome = study.outcome;
  Json json;
  json["format"] = format_version;
  json["version"] = study.version;
  json["machine"] = {{"cpu", study.machine.cpu}, {"cores", study.machine.cores}, {"os", study.machine.os}};
  json["threads"] = study.threads;
  json["problem"] = study.problem;
  json["quantity"] = study.quantity.text();
  json["unit"] = study.quantity.unit();
  json["tolerance"] = {{"value", study.tolerance.value}, {"relative", study.tolerance.relative}};
  json["allowed_error"] = outcome.allowed;
  json["magnitude"] = outcome.magnitude;
  json["safety_factor"] = lean_safety;
  json["end"] = end_word(outcome.end);
  json["lean"] = name_or_null(outcome, outcome.lean);
  json["file"] = study.file;
  json["verified_against"] = name_or_null(outcome, outcome.above);
  json["full"] = name_or_null(outcome, outcome.full);
  json["full_seconds"] = {{"value", study.full_seconds()},
                          {"from", study.known_seconds ? "known"
                                   : outcome.full      ? "measured"
                                                       : "predicted"}};
  json["search_seconds"] = study.seconds;
  json["costs_more_than_full"] = study.costs_more_than_full();
  json["rungs"] = Json::array();
  for (const LeanRung& rung : outcome.rungs) json["rungs"].push_back(rung_json(rung, study.ladder));
  json["residual_estimates"] = Json::array();
  for (const ResidualTrial& trial : outcome.residual_trials)
    json["residual_estimates"].push_back(trial_json(trial, outcome));
  json["omissions"] = Json::array();
  for (const OmissionTrial& trial : outcome.omissions) {
    json["omissions"].push_back({{"what", trial.what},
                                 {"change", number_or_null(trial.change)},
                                 {"left_out", trial.left_out},
                                 {"why", trial.why}});
  }
  json["not_applicable"] = Json::array();
  for (const NotApplicable& one : study.ladder.not_applicable)
    json["not_applicable"].push_back({{"what", one.name}, {"why", one.reason}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace taut
