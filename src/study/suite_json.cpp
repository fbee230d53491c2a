#include "study/suite_json.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "study/residuals_json.h"

namespace taut {
namespace {

using Json = nlohmann::ordered_json;

Json run_json(const SuiteRun& run) {
  if (run.outcome != "finished") return {{"outcome", run.outcome}, {"message", run.message}};
  return {{"outcome", run.outcome},
          {"status", to_string(run.status)},
          {"message", run.message},
          {"false_success", run.false_success},
          {"maximise", run.maximise},
          {"objective", run.objective},
          {"violation", run.violation},
          {"stationarity", run.stationarity},
          {"seconds", run.seconds},
          {"linear_solves", run.counts.linear_solves},
          {"function_evaluations", run.counts.function_evaluations}};
}

Json score_json(const SuiteScore& score) {
  return {{"false_successes", score.false_successes},
          {"correct", score.correct},
          {"solved", score.solved},
          {"median_seconds", score.median_seconds},
          {"mean_seconds", score.mean_seconds},
          {"linear_solves", score.linear_solves}};
}

}  // namespace

std::string suite_run_line(const SuiteRun& run) {
  return run_json(run).dump(-1, ' ', false, Json::error_handler_t::replace);
}

SuiteRun parse_suite_run(std::string_view line) try {
  const Json json = Json::parse(line);
  SuiteRun run;
  run.outcome = json.at("outcome");
  run.message = json.at("message");
  run.status = status_from_string(json.at("status").get<std::string>());
  run.false_success = json.at("false_success");
  run.maximise = json.at("maximise");
  run.objective = number(json.at("objective"));
  run.violation = number(json.at("violation"));
  run.stationarity = number(json.at("stationarity"));
  run.seconds = json.at("seconds");
  run.counts.linear_solves = json.at("linear_solves");
  run.counts.function_evaluations = json.at("function_evaluations");
  return run;
} catch (const Json::exception& error) {
  throw std::runtime_error(std::string("not a run of a suite: ") + error.what());
}

std::string suite_text(const Suite& suite) {
  Json json;
  json["suite"] = suite.folder;
  json["version"] = suite.version;
  json["machine"] = {{"cpu", suite.machine.cpu}, {"cores", suite.machine.cores}, {"os", suite.machine.os}};
  json["repeat"] = suite.repeat;
  json["time_limit"] = suite.time_limit;
  json["interrupted"] = suite.interrupted;
  json["models"] = Json::array();
  for (const SuiteModel& model : suite.models)
    json["models"].push_back(
        {{"name", model.name}, {"file", model.file}, {"reference", model.reference ? Json(*model.reference) : Json()}});
  json["entries"] = Json::array();
  const std::vector<Profile> profiles = performance_of(suite);
  for (std::size_t k = 0; k < suite.entries.size(); ++k) {
    const SuiteEntry& entry = suite.entries[k];
    Json runs = Json::object();
    for (std::size_t model = 0; model < suite.models.size(); ++model) {
      Json& run = runs[suite.models[model].name] = run_json(entry.runs[model]);
      run["correct"] = is_correct(suite.models[model], entry.runs[model]);
    }
    json["entries"].push_back({{"label", entry.chosen.label},
                               {"solver", entry.chosen.solver},
                               {"settings", entry.chosen.overrides},
                               {"score", score_json(score_of(suite, entry))},
                               {"performance_profile", {{"x", profiles[k].x}, {"share", profiles[k].share}}},
                               {"runs", runs}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace taut
