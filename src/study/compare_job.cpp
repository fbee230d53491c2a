#include "study/compare_job.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace taut {

using Json = nlohmann::ordered_json;

std::string job_text(const CompareJob& job) {
  Json json;
  json["problem"] = job.problem;
  json["overrides"] = job.overrides;
  json["states"] = job.states;
  json["records"] = job.records;
  json["cold"] = job.cold;
  json["untimed"] = job.untimed;
  json["steps"] = job.steps;
  json["repeat"] = job.repeat;
  json["threads"] = job.threads;
  json["seconds"] = job.seconds;
  json["memory_bytes"] = job.memory_bytes;
  json["scene_hash"] = job.scene_hash;
  json["trajectory_hash"] = job.trajectory_hash;
  json["version"] = job.version;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

CompareJob parse_job(const std::string& text) try {
  const Json json = Json::parse(text);
  CompareJob job;
  json.at("problem").get_to(job.problem);
  json.at("overrides").get_to(job.overrides);
  json.at("states").get_to(job.states);
  json.at("records").get_to(job.records);
  json.at("cold").get_to(job.cold);
  json.at("untimed").get_to(job.untimed);
  json.at("steps").get_to(job.steps);
  json.at("repeat").get_to(job.repeat);
  json.at("threads").get_to(job.threads);
  json.at("seconds").get_to(job.seconds);
  json.at("memory_bytes").get_to(job.memory_bytes);
  json.at("scene_hash").get_to(job.scene_hash);
  json.at("trajectory_hash").get_to(job.trajectory_hash);
  json.at("version").get_to(job.version);
  return job;
} catch (const Json::exception& error) {
  throw std::runtime_error(std::string("not a job of taut compare: ") + error.what());
}

std::string outcome_of(const ChildOutcome& child) {
  if (child.end == ChildEnd::interrupted) return "interrupted";
  if (child.end == ChildEnd::time_limit || (child.end == ChildEnd::exited && child.code == worker_out_of_time))
    return "time_limit";
  if (child.end == ChildEnd::crashed) return "crash: " + signal_name(child.signal);
  if (child.end == ChildEnd::memory_limit || child.code == worker_out_of_memory) return "out_of_memory";
  if (child.code == worker_refused) return "refused";
  return child.code == worker_finished ? "finished" : "error";
}

std::filesystem::path step_file(const std::filesystem::path& folder, int step) {
  return folder / fmt::format("{:05}.bin", step);
}

}  // namespace taut
