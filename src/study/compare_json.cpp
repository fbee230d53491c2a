#include "study/compare_json.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "study/residuals_json.h"

namespace taut {
namespace {

using Json = nlohmann::ordered_json;
constexpr int format_version = 1;

/// The residuals with what the judge says of each constraint.
Json judged_json(const Residuals& r) {
  Json json = residuals_json(r), violations = Json::object();
  for (const Violation& violation : r.violations)
    violations[violation.constraint] = {
        {"max", violation.max}, {"where", violation.where}, {"element", violation.element}};
  json["finite"] = r.finite;
  json["violations"] = violations;
  return json;
}

Residuals read_judged(const Json& json) {
  Residuals r = read_residuals(json);
  r.finite = json.at("finite");
  for (const auto& [constraint, violation] : json.at("violations").items())
    r.violations.push_back(
        {constraint, number(violation.at("max")), violation.at("where"), violation.at("element").get<Index>()});
  return r;
}

Json counts_json(const Counts& counts) {
  return {{"outer", counts.outer},
          {"linear_solves", counts.linear_solves},
          {"factorizations", counts.factorizations},
          {"pivoted_factorizations", counts.pivoted_factorizations},
          {"inner_iterations", counts.inner_iterations},
          {"screened", counts.screened},
          {"screening_failures", counts.screening_failures},
          {"symbolic_analyses", counts.symbolic_analyses},
          {"matrix_allocations", counts.matrix_allocations},
          {"function_evaluations", counts.function_evaluations},
          {"factor_flops", counts.factor_flops}};
}

Json timings_json(const Timings& t) {
  return {{"total", t.total},
          {"assembly", t.assembly},
          {"analysis", t.analysis},
          {"factorization", t.factorization},
          {"solve", t.solve}};
}

Timings read_timings(const Json& json) {
  return {number(json.at("total")), number(json.at("assembly")), number(json.at("analysis")),
          number(json.at("factorization")), number(json.at("solve"))};
}

Json trial_json(const StepTrial& trial) {
  Json worst = Json::array();
  for (const WorstElement& element : trial.worst_elements)
    worst.push_back(
        {{"constraint", element.constraint}, {"element", element.element}, {"violation", element.violation}});
  return {{"step", trial.step},
          {"claimed", to_string(trial.result.status)},
          {"judged", to_string(trial.judged)},
          {"message", trial.result.message},
          {"objective", trial.objective},
          {"objective_at_start", trial.objective_at_start},
          {"residuals", judged_json(trial.residuals)},
          {"worst_elements", worst},
          {"warm_start", trial.warm_start},
          {"counts", counts_json(trial.result.counts)},
          {"seconds", trial.seconds},
          {"seconds_by_phase", timings_json(trial.result.timings)},
          {"warm_up_seconds", trial.warm_up_seconds},
          {"peak_memory_bytes", trial.peak_memory_bytes}};
}

StepTrial read_trial(const Json& json) {
  StepTrial trial;
  trial.step = json.at("step");
  trial.result.status = status_from_string(json.at("claimed").get<std::string>());
  trial.judged = status_from_string(json.at("judged").get<std::string>());
  trial.result.message = json.at("message");
  trial.objective = number(json.at("objective"));
  trial.objective_at_start = number(json.at("objective_at_start"));
  trial.residuals = read_judged(json.at("residuals"));
  for (const Json& worst : json.at("worst_elements"))
    trial.worst_elements.push_back({worst.at("constraint"), worst.at("element"), number(worst.at("violation"))});
  trial.warm_start = json.at("warm_start");
  trial.result.counts = read_counts(json.at("counts"));
  trial.seconds = json.at("seconds").get<std::vector<double>>();
  trial.result.timings = read_timings(json.at("seconds_by_phase"));
  trial.warm_up_seconds = number(json.at("warm_up_seconds"));
  trial.peak_memory_bytes = json.at("peak_memory_bytes");
  return trial;
}

Json spread_json(const Spread& spread) { return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}}; }

Json summary_json(const EntryRun& run) {
  const EntrySummary s = summarize(run);
  Json json{{"solved", s.solved},
            {"steps", run.steps_asked},
            {"false_successes", s.false_successes},
            {"failures", s.failures},
            {"largest_residual", s.residual}};
  json["distance"] = nullptr;
  if (s.distances > 0)
    json["distance"] = {
        {"positions", s.position_distance}, {"objective", s.objective_distance}, {"steps", s.distances}};
  json["seconds_per_step"] = spread_json(s.seconds);
  json["linear_solves_per_step"] = s.linear_solves;
  return json;
}

Json entry_json(const EntryRun& run) {
  Json json{{"label", run.label},
            {"solver", run.solver},
            {"problem_group", run.group},
            {"overrides", run.overrides},
            {"tolerance",
             {{"stationarity", run.tolerance.stationarity},
              {"feasibility", run.tolerance.feasibility},
              {"complementarity", run.tolerance.complementarity}}},
            {"outcome", run.outcome},
            {"message", run.message},
            {"summary", summary_json(run)},
            {"on_front", run.on_front},
            {"seconds", run.seconds},
            {"peak_memory_bytes", run.peak_memory_bytes},
            {"resumed", run.resumed},
            {"folder", run.folder}};
  json["steps"] = Json::array();
  for (const StepTrial& trial : run.trials) {
    Json step = trial_json(trial);
    step["false_success"] = trial.false_success();
    step["distance"] = nullptr;
    if (trial.distance)
      step["distance"] = {{"positions", trial.distance->positions},
                          {"objective", trial.distance->objective},
                          {"reference", trial.distance->reference}};
    json["steps"].push_back(step);
  }
  return json;
}

}  // namespace

std::string trial_line(const StepTrial& trial) {
  return trial_json(trial).dump(-1, ' ', false, Json::error_handler_t::replace);
}

StepTrial parse_trial(std::string_view line) {
  try {
    return read_trial(Json::parse(line));
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string("not a step of taut compare: ") + error.what());
  }
}

std::string comparison_text(const Comparison& comparison) {
  Json json;
  json["format"] = format_version;
  json["interrupted"] = comparison.interrupted;
  json["free"] = comparison.free;
  json["cold"] = comparison.cold;
  json["repeat"] = comparison.repeat;
  json["threads"] = comparison.threads;
  json["time_limit"] = comparison.time_limit;
  json["memory_limit_bytes"] = comparison.memory_limit_bytes;
  json["version"] = comparison.version;
  json["machine"] = {
      {"cpu", comparison.machine.cpu}, {"cores", comparison.machine.cores}, {"os", comparison.machine.os}};
  json["problems"] = Json::array();
  for (const ProblemComparison& problem : comparison.problems) {
    Json entry{{"name", problem.name},     {"file", problem.file},    {"hash", problem.hash},
               {"folder", problem.folder}, {"size", problem.size},    {"steps", problem.steps_asked},
               {"trajectory", nullptr},    {"entries", Json::array()}};
    if (!comparison.free) {
      entry["trajectory"] = entry_json(problem.trajectory);
      entry["trajectory"]["solved"] = problem.trajectory_solved;
    }
    for (const EntryRun& run : problem.entries) entry["entries"].push_back(entry_json(run));
    json["problems"].push_back(entry);
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace taut
