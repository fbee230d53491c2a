#include "study/records_json.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "study/residuals_json.h"

namespace taut {
namespace {

using Json = nlohmann::ordered_json;
constexpr int format_version = 1;

std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace); }

Json counts_json(const Counts& counts) {
  return {{"outer", counts.outer},
          {"linear_solves", counts.linear_solves},
          {"factorizations", counts.factorizations},
          {"pivoted_factorizations", counts.pivoted_factorizations},
          {"inner_iterations", counts.inner_iterations},
          {"screened", counts.screened},
          {"screening_failures", counts.screening_failures},
          {"function_evaluations", counts.function_evaluations},
          {"factor_flops", counts.factor_flops}};
}

Json timings_json(const Timings& timings) {
  return {{"assembly", timings.assembly},
          {"analysis", timings.analysis},
          {"factorization", timings.factorization},
          {"solve", timings.solve}};
}

Json numbers_json(const NamedNumbers& numbers) {
  Json json = Json::object();
  for (const auto& [name, value] : numbers) json[name] = value;
  return json;
}

Json violations_json(const StepRecord& record) {
  Json json = Json::object();
  for (const Violation& violation : record.residuals.violations) {
    json[violation.constraint] = {{"max", violation.max}, {"where", violation.where}};
  }
  for (const Penetration& penetration : record.penetrations) {
    json[penetration.constraint]["edge_penetration"] = penetration.edge;
    json[penetration.constraint]["face_penetration"] = penetration.face;
  }
  return json;
}

Json violations_json(const RunSummary& summary) {
  Json json = Json::object();
  for (const WorstViolation& worst : summary.violations) {
    Json& violation = json[worst.constraint];
    violation = {{"max", worst.max}, {"where", worst.where}, {"step", worst.step}};
    if (!worst.penetration) continue;
    violation["edge_penetration"] = worst.penetration->edge;
    violation["face_penetration"] = worst.penetration->face;
  }
  return json;
}

Json worst_residuals_json(const RunSummary& s) {
  return {{"stationarity", s.stationarity.scaled},
          {"stationarity_unscaled", s.stationarity.unscaled},
          {"force_scale", s.force_scale},
          {"stationarity_step", s.stationarity.step},
          {"worst_node", s.worst_node},
          {"feasibility", s.feasibility.scaled},
          {"feasibility_unscaled", s.feasibility.unscaled},
          {"feasibility_step", s.feasibility.step},
          {"complementarity", s.complementarity.scaled},
          {"complementarity_unscaled", s.complementarity.unscaled},
          {"complementarity_step", s.complementarity.step}};
}

void read_worst_residuals(const Json& json, RunSummary& s) {
  const auto read = [&json](const std::string& name) {
    return Worst{number(json.at(name)), number(json.at(name + "_unscaled")), json.at(name + "_step").get<int>()};
  };
  s.stationarity = read("stationarity");
  s.feasibility = read("feasibility");
  s.complementarity = read("complementarity");
  s.force_scale = number(json.at("force_scale"));
  s.worst_node = json.at("worst_node");
}

void read_violations(const Json& json, RunSummary& s) {
  for (const auto& [constraint, violation] : json.items()) {
    WorstViolation worst{constraint, number(violation.at("max")), violation.at("where"), violation.at("step"), {}};
    if (violation.contains("edge_penetration")) {
      worst.penetration =
          Penetration{constraint, number(violation.at("edge_penetration")), number(violation.at("face_penetration"))};
    }
    s.violations.push_back(worst);
  }
}

Json seconds_json(const RunSeconds& seconds) {
  Json json = {{"total", seconds.total}, {"solver", seconds.solver.total}};
  json.update(timings_json(seconds.solver));
  json["judging"] = seconds.judging;
  json["output"] = seconds.output;
  return json;
}

void read_seconds(const Json& json, RunSeconds& seconds) {
  seconds.total = number(json.at("total"));
  seconds.solver = {number(json.at("solver")), number(json.at("assembly")), number(json.at("analysis")),
                    number(json.at("factorization")), number(json.at("solve"))};
  seconds.judging = number(json.at("judging"));
  seconds.output = number(json.at("output"));
}

Json worst_elements_json(const RunSummary& summary) {
  Json json = Json::array();
  for (const WorstElement& worst : summary.worst_elements) {
    json.push_back({{"constraint", worst.constraint}, {"element", worst.element}, {"violation", worst.violation}});
  }
  return json;
}

Json probes_json(const RunSummary& summary) {
  Json json = Json::object();
  for (const ProbeValue& probe : summary.probes) {
    json[probe.name]["value"] = probe.value;
    if (!probe.expected) continue;
    json[probe.name]["expected"] = {{"value", probe.expected->value},
                                    {probe.expected->relative ? "relative" : "absolute", probe.expected->tolerance},
                                    {"source", probe.expected->source}};
    json[probe.name]["within"] = probe.within();
  }
  return json;
}

std::vector<ProbeValue> read_probes(const Json& json) {
  std::vector<ProbeValue> probes;
  for (const auto& [name, probe] : json.items()) {
    ProbeValue& read = probes.emplace_back(ProbeValue{name, number(probe.at("value")), {}});
    if (!probe.contains("expected")) continue;
    const Json& expected = probe["expected"];
    const bool relative = expected.contains("relative");
    read.expected = {number(expected.at("value")), number(expected.at(relative ? "relative" : "absolute")), relative,
                     expected.at("source")};
  }
  return probes;
}

Json modes_json(const std::vector<ModeRecord>& modes) {
  Json json = Json::array();
  for (const ModeRecord& mode : modes) json.push_back({{"frequency", mode.frequency}, {"residual", mode.residual}});
  return json;
}

std::vector<ModeRecord> read_modes(const Json& json) {
  std::vector<ModeRecord> modes;
  for (const Json& mode : json) modes.push_back({number(mode.at("frequency")), number(mode.at("residual"))});
  return modes;
}

Json unfinished_json(const std::optional<UnfinishedStep>& unfinished) {
  if (!unfinished) return nullptr;
  return {{"step", unfinished->step},
          {"message", unfinished->message},
          {"stationarity", unfinished->stationarity},
          {"feasibility", unfinished->feasibility},
          {"complementarity", unfinished->complementarity}};
}

NamedNumbers read_numbers(const Json& json) {
  NamedNumbers numbers;
  for (const auto& [name, value] : json.items()) numbers.emplace_back(name, number(value));
  return numbers;
}

StepRecord step_of(const Json& json) {
  StepRecord record;
  record.step = json.at("step");
  record.time = number(json.at("time"));
  record.status = status_from_string(json.at("status").get<std::string>());
  record.claimed = json.contains("claimed") ? status_from_string(json["claimed"].get<std::string>()) : record.status;
  record.message = json.at("message");
  record.residuals = read_residuals(json.at("residuals"));
  for (const auto& [constraint, v] : json.at("violations").items()) {
    record.residuals.violations.push_back({constraint, number(v.at("max")), v.at("where"), -1});
    if (!v.contains("edge_penetration")) continue;
    record.penetrations.push_back({constraint, number(v.at("edge_penetration")), number(v.at("face_penetration"))});
  }
  record.objective = number(json.at("objective"));
  record.energies = read_numbers(json.at("energies"));
  record.penalties = read_numbers(json.at("penalties"));
  if (json.contains("probes")) record.probes = read_numbers(json["probes"]);
  if (json.contains("modes")) record.modes = read_modes(json["modes"]);
  const Json &counts = json.at("counts"), &seconds = json.at("seconds");
  record.counts.outer = counts.at("outer");
  record.counts.linear_solves = counts.at("linear_solves");
  record.counts.factorizations = counts.at("factorizations");
  record.counts.pivoted_factorizations = counts.value("pivoted_factorizations", 0L);
  record.counts.inner_iterations = counts.value("inner_iterations", 0L);
  record.counts.screened = counts.value("screened", 0L);
  record.counts.screening_failures = counts.value("screening_failures", 0L);
  record.counts.function_evaluations = counts.at("function_evaluations");
  record.counts.factor_flops = counts.value("factor_flops", 0.0);
  record.seconds = {number(seconds.at("total")), number(seconds.at("assembly")), number(seconds.at("analysis")),
                    number(seconds.at("factorization")), number(seconds.at("solve"))};
  record.judging = number(seconds.at("judging"));
  return record;
}

RunSummary summary_of(const Json& json) {
  if (json.at("format") != format_version) throw std::runtime_error("summary.json is of another version");
  RunSummary s;
  s.input_hash = json.at("input_hash");
  s.problem = json.at("problem");
  s.solver = json.at("solver");
  s.status = status_from_string(json.at("status").get<std::string>());
  s.message = json.at("message");
  s.steps_done = json.at("steps").at("done");
  s.steps_solved = json.at("steps").at("solved");
  s.steps_asked = json.at("steps").at("asked");
  s.objective = number(json.at("objective"));
  read_worst_residuals(json.at("residuals"), s);
  read_violations(json.at("violations"), s);
  s.worst_elements_step = json.at("worst_elements_step");
  for (const Json& worst : json.at("worst_elements")) {
    s.worst_elements.push_back({worst.at("constraint"), worst.at("element"), number(worst.at("violation"))});
  }
  if (const Json& u = json.at("unfinished_step"); !u.is_null()) {
    s.unfinished = UnfinishedStep{u.at("step"), u.at("message"), number(u.at("stationarity")),
                                  number(u.at("feasibility")), number(u.at("complementarity"))};
  }
  if (json.contains("probes")) s.probes = read_probes(json["probes"]);
  if (json.contains("modes")) s.modes = read_modes(json["modes"]);
  s.counts = read_counts(json.at("counts"));
  read_seconds(json.at("seconds"), s.seconds);
  s.peak_memory_bytes = json.at("peak_memory_bytes");
  s.version = json.at("version");
  const Json& machine = json.at("machine");
  s.machine = {machine.at("cpu"), machine.at("os"), machine.at("cores").get<int>()};
  s.threads = machine.at("threads");
  s.notes = json.at("notes").get<std::vector<std::string>>();
  s.files = json.at("files").get<std::vector<std::string>>();
  return s;
}

}  // namespace

std::string summary_text(const RunSummary& s) {
  Json json;
  json["format"] = format_version;
  json["input_hash"] = s.input_hash;
  json["problem"] = s.problem;
  json["solver"] = s.solver;
  json["status"] = to_string(s.status);
  json["message"] = s.message;
  json["steps"] = {{"done", s.steps_done}, {"solved", s.steps_solved}, {"asked", s.steps_asked}};
  json["objective"] = s.objective;
  json["residuals"] = worst_residuals_json(s);
  json["violations"] = violations_json(s);
  json["worst_elements_step"] = s.worst_elements_step;
  json["worst_elements"] = worst_elements_json(s);
  json["unfinished_step"] = unfinished_json(s.unfinished);
  json["probes"] = probes_json(s);
  if (!s.modes.empty()) json["modes"] = modes_json(s.modes);
  json["counts"] = counts_json(s.counts);
  json["counts"]["symbolic_analyses"] = s.counts.symbolic_analyses;
  json["counts"]["matrix_allocations"] = s.counts.matrix_allocations;
  json["seconds"] = seconds_json(s.seconds);
  json["peak_memory_bytes"] = s.peak_memory_bytes;
  json["version"] = s.version;
  json["machine"] = {{"cpu", s.machine.cpu}, {"cores", s.machine.cores}, {"threads", s.threads}, {"os", s.machine.os}};
  json["notes"] = s.notes;
  json["files"] = s.files;
  return text_of(json) + "\n";
}

RunSummary parse_summary(std::string_view text) {
  try {
    return summary_of(Json::parse(text));
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string("not a summary of Taut: ") + error.what());
  }
}

std::string step_line(const StepRecord& record) {
  Json json;
  json["step"] = record.step;
  json["time"] = record.time;
  json["status"] = to_string(record.status);
  json["claimed"] = to_string(record.claimed);
  json["message"] = record.message;
  json["residuals"] = residuals_json(record.residuals);
  json["violations"] = violations_json(record);
  json["objective"] = record.objective;
  json["energies"] = numbers_json(record.energies);
  json["penalties"] = numbers_json(record.penalties);
  if (!record.probes.empty()) json["probes"] = numbers_json(record.probes);
  if (!record.modes.empty()) json["modes"] = modes_json(record.modes);
  json["counts"] = counts_json(record.counts);
  json["seconds"] = {{"total", record.seconds.total}};
  json["seconds"].update(timings_json(record.seconds));
  json["seconds"]["judging"] = record.judging;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

StepRecord parse_step(std::string_view line) {
  try {
    return step_of(Json::parse(line));
  } catch (const std::exception& error) {
    throw std::runtime_error(std::string("not a step of Taut: ") + error.what());
  }
}

}  // namespace taut
