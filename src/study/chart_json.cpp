#include "study/chart_json.h"

#include <nlohmann/json.hpp>

namespace taut {
namespace {

using Json = nlohmann::ordered_json;
constexpr int format_version = 1;

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json point_json(const ChartPoint& p) {
  Json json;
  json["solver"] = p.solver;
  json["value"] = p.value;
  json["number"] = p.number;
  json["status"] = p.status;
  json["outcome"] = p.outcome;
  json["message"] = p.message;
  json["resumed"] = p.resumed;
  json["steps"] = {{"done", p.steps_done}, {"solved", p.steps_solved}, {"asked", p.steps_asked}};
  json["false_successes"] = p.false_successes;
  json["error"] = optional_json(p.error);
  json["on_front"] = p.on_front;
  json["seconds"] = p.seconds;
  json["solver_seconds"] = p.solver_seconds;
  json["linear_solves"] = p.counts.linear_solves;
  json["factorizations"] = p.counts.factorizations;
  json["factor_flops"] = p.counts.factor_flops;
  json["multiplier_updates"] = p.counts.outer;
  json["peak_memory_bytes"] = p.peak_memory_bytes;
  json["violation"] = p.violation;
  json["probes"] = Json::object();
  for (const auto& [name, value] : p.probes) json["probes"][name] = value;
  json["command"] = p.command;
  json["folder"] = p.folder;
  return json;
}

Json reference_json(const ChartReference& r) {
  Json json{{"group", r.group},
            {"kind", r.kind},
            {"text", r.text},
            {"solver", r.solver},
            {"not_independent_of", r.not_independent_of},
            {"estimated_error", optional_json(r.estimated_error)},
            {"order", optional_json(r.order)},
            {"runs", Json::array()}};
  for (const ChartPoint& run : r.runs) json["runs"].push_back(point_json(run));
  return json;
}

Json history_json(const ChartHistory& h) {
  Json json{{"step", h.step}, {"run", point_json(h.run)}, {"iterates", Json::array()}};
  for (const HistoryPoint& p : h.points) {
    json["iterates"].push_back({{"linear_solves", p.linear_solves},
                                {"seconds", p.seconds},
                                {"stationarity", p.stationarity},
                                {"feasibility", p.feasibility},
                                {"complementarity", p.complementarity},
                                {"penalty", p.penalty}});
  }
  return json;
}

Json problem_json(const ProblemChart& p) {
  Json json{{"name", p.name}, {"problem", p.problem},        {"folder", p.folder},      {"error", to_string(p.error)},
            {"size", p.size}, {"references", Json::array()}, {"points", Json::array()}, {"histories", Json::array()}};
  for (const ChartReference& reference : p.references) json["references"].push_back(reference_json(reference));
  for (const ChartPoint& point : p.points) json["points"].push_back(point_json(point));
  for (const ChartHistory& history : p.histories) json["histories"].push_back(history_json(history));
  return json;
}

Json profile_json(const ChartData& chart, const std::vector<Profile>& profiles) {
  Json json = Json::object();
  for (std::size_t k = 0; k < profiles.size(); ++k)
    json[chart.solvers[k]] = {{"x", profiles[k].x}, {"share", profiles[k].share}};
  return json;
}

}  // namespace

std::string chart_text(const ChartData& chart) {
  Json json;
  json["format"] = format_version;
  json["version"] = chart.version;
  json["machine"] = {{"cpu", chart.machine.cpu}, {"cores", chart.machine.cores}, {"os", chart.machine.os}};
  json["threads"] = chart.threads;
  json["interrupted"] = chart.interrupted;
  json["knob"] = chart.knob.name;
  json["solvers"] = chart.solvers;
  json["max_seconds"] = chart.max_seconds;
  json["accuracy"] = chart.accuracy;
  json["problems"] = Json::array();
  for (const ProblemChart& problem : chart.problems) json["problems"].push_back(problem_json(problem));
  if (chart.problems.size() > 1) {
    const ChartProfiles profiles = profiles_of(chart);
    json["profiles"] = {{"performance", profile_json(chart, profiles.performance)},
                        {"data", profile_json(chart, profiles.data)}};
    json["scores"] = Json::array();
    for (const SolverScore& s : scores_of(chart)) {
      json["scores"].push_back({{"solver", s.solver},
                                {"runs", s.runs},
                                {"false_successes", s.false_successes},
                                {"correct", s.correct},
                                {"solved", s.solved},
                                {"mean_seconds", s.mean_seconds}});
    }
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace taut
