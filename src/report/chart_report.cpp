#include "report/chart_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "report/chart_tables.h"
#include "report/command_text.h"
#include "report/profile_chart.h"
#include "study/pareto.h"

namespace taut {
namespace {

using Json = nlohmann::json;

std::string status_of(const ChartPoint& point) { return point.false_successes > 0 ? "false success" : point.status; }

std::string label_of(const ChartData& chart, const ChartPoint& point) {
  return point.value.empty() ? point.solver : chart.knob.name + " " + point.value;
}

Json axis(const std::string& label, bool log = true) { return {{"label", label}, {"log", log}}; }

std::string error_label(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::position:
      return "distance at the end / size";
    case ErrorKind::energy:
      return "error of the energy at the end, relative";
    case ErrorKind::probe:
      return "largest error of a probe at the end, relative";
    case ErrorKind::violation:
      return "largest violation of any step, scaled";
  }
  return "";
}

/// What a point costs, on the x axis of a work-precision diagram.
struct Cost {
  std::string id, label;
  double (*of)(const ChartPoint&);
};

const std::vector<Cost>& costs() {
  static const std::vector<Cost> all{
      {"", "seconds of the solver",
       [](const ChartPoint& p) { return p.solver_seconds > 0 ? p.solver_seconds : p.seconds; }},
      {"_linear_solves", "linear solves",
       [](const ChartPoint& p) { return static_cast<double>(p.counts.linear_solves); }},
      {"_flops", "flops of the factorisations", [](const ChartPoint& p) { return p.counts.factor_flops; }},
      {"_memory", "peak memory, MB",
       [](const ChartPoint& p) { return static_cast<double>(p.peak_memory_bytes) / 1e6; }}};
  return all;
}

/// One series per solver of the points that `x` knows.
template <class X>
Json series_of(const ChartData& chart, const ProblemChart& problem, const X& x) {
  Json series = Json::array();
  for (const std::string& solver : chart.solvers) {
    Json points = Json::array();
    for (const ChartPoint& point : problem.points) {
      if (point.solver != solver || point.outcome == "interrupted" || !(x(point) > 0)) continue;
      points.push_back({{"x", x(point)},
                        {"y", point.error ? Json(*point.error) : Json()},
                        {"status", status_of(point)},
                        {"label", label_of(chart, point)},
                        {"command", command_text(point.command)}});
    }
    series.push_back({{"name", solver}, {"line", true}, {"points", points}});
  }
  return series;
}

bool has_points(const Json& series) {
  return std::any_of(series.begin(), series.end(), [](const Json& one) { return !one["points"].empty(); });
}

Json front_of(const ProblemChart& problem, const Cost& cost) {
  std::vector<WorkPrecision> work;
  for (const ChartPoint& point : problem.points) {
    const bool counts = point.solved() && point.error && cost.of(point) > 0;
    work.push_back({cost.of(point), counts ? *point.error : std::nan("")});
  }
  Json front = Json::array();
  for (const std::size_t k : pareto_front(work)) front.push_back({work[k].cost, work[k].error});
  return front;
}

void add_work_precision(const ChartData& chart, const ProblemChart& problem, const std::string& name, Json& charts) {
  for (const Cost& cost : costs()) {
    const Json series = series_of(chart, problem, cost.of);
    if (!has_points(series)) continue;
    charts.push_back({{"id", "work_precision" + cost.id + "_" + name},
                      {"title", problem.name + ": error against " + cost.label},
                      {"x", axis(cost.label)},
                      {"y", axis(error_label(problem.error))},
                      {"series", series},
                      {"front", front_of(problem, cost)}});
  }
  const Json series = series_of(chart, problem, [](const ChartPoint& point) { return point.number; });
  if (!has_points(series)) return;
  const std::string label = chart.knob.kind == KnobKind::mesh ? "width of a cell / the problem's own" : chart.knob.name;
  charts.push_back({{"id", "error_" + name},
                    {"title", problem.name + ": error against " + chart.knob.name},
                    {"x", axis(label)},
                    {"y", axis(error_label(problem.error))},
                    {"series", series}});
}

/// What an iterate is drawn by.
struct Track {
  std::string id, label;
  double HistoryPoint::*value;
};

void add_histories(const ProblemChart& problem, const std::string& name, Json& charts) {
  static const std::vector<Track> tracks{{"violation", "violation, scaled", &HistoryPoint::feasibility},
                                         {"stationarity", "stationarity, scaled", &HistoryPoint::stationarity},
                                         {"penalty", "largest penalty", &HistoryPoint::penalty}};
  for (const Track& track : tracks) {
    for (const bool by_seconds : {false, true}) {
      Json series = Json::array();
      for (const ChartHistory& history : problem.histories) {
        Json points = Json::array();
        for (std::size_t k = 0; k < history.points.size(); ++k) {
          const HistoryPoint& p = history.points[k];
          // What is exactly zero, as a violation or a penalty may be, has no place on a logarithmic axis.
          if (!(p.*track.value > 0)) continue;
          points.push_back({{"x", by_seconds ? p.seconds : static_cast<double>(p.linear_solves)},
                            {"y", p.*track.value},
                            {"label", fmt::format("iterate {}", k)}});
        }
        if (!points.empty()) series.push_back({{"name", history.run.solver}, {"line", true}, {"points", points}});
      }
      if (series.empty()) continue;
      charts.push_back({{"id", "history_" + track.id + (by_seconds ? "_seconds_" : "_") + name},
                        {"title", fmt::format("{}, step {}: {} of the iterates", problem.name,
                                              problem.histories.front().step, track.id)},
                        {"x", axis(by_seconds ? "seconds of the solver" : "linear solves", false)},
                        {"y", axis(track.label)},
                        {"series", series}});
    }
  }
}

void add_profiles(const ChartData& chart, Json& charts) {
  const ChartProfiles profiles = profiles_of(chart);
  charts.push_back(profile_chart("performance_profile", "Performance profile", "seconds / those of the fastest", 1,
                                 chart.solvers, profiles.performance));
  double first = 1e300;
  for (const Profile& profile : profiles.data) {
    if (!profile.x.empty()) first = std::min(first, profile.x.front() / 1.1);
  }
  charts.push_back(profile_chart("data_profile", "Data profile", "linear solves a step", first < 1e300 ? first : 1,
                                 chart.solvers, profiles.data));
}

Json table_json(const std::string& id, const std::string& title, const TextTable& table) {
  return {{"id", id},
          {"title", title},
          {"columns", table.front()},
          {"rows", std::vector<std::vector<std::string>>(table.begin() + 1, table.end())}};
}

/// As numbers, so that a table sorts by them.
Json points_table(const ProblemChart& problem, const std::string& name) {
  Json rows = Json::array();
  for (const ChartPoint& p : problem.points) {
    rows.push_back({p.false_successes, p.status, p.solver, p.value, p.error ? Json(*p.error) : Json(),
                    p.on_front ? "*" : "", p.solver_seconds, p.seconds, p.counts.linear_solves,
                    p.counts.factor_flops / 1e9, static_cast<double>(p.peak_memory_bytes) / 1e6,
                    command_text(p.command)});
  }
  return {
      {"id", "points_" + name},
      {"title", problem.name},
      {"columns",
       {"false", "status", "solver", "value", "error", "front", "s", "s in all", "solves", "Gflop", "MB", "command"}},
      {"rows", rows}};
}

}  // namespace

Json chart_report(const ChartData& chart, const std::string& command) {
  Json report{{"title", "Speed against accuracy"}, {"command", command},      {"version", chart.version},
              {"summary", Json::array()},          {"charts", Json::array()}, {"tables", Json::array()}};
  report["machine"] = {{"cpu", chart.machine.cpu},
                       {"cores", chart.machine.cores},
                       {"threads of a solver", chart.threads},
                       {"os", chart.machine.os}};
  report["settings"] = {{"knob", chart.knob.name.empty() ? "none" : chart.knob.name},
                        {"solvers", chart.solvers},
                        {"seconds for a run", chart.max_seconds},
                        {"correct up to an error of", chart.accuracy}};
  if (chart.problems.size() > 1) {
    report["tables"].push_back(table_json("scores", "Solvers over all problems", chart_scores(chart)));
    add_profiles(chart, report["charts"]);
  }
  for (const ProblemChart& problem : chart.problems) {
    const std::string name = problem.folder.substr(problem.folder.rfind('/') + 1);
    for (const std::string& line : chart_words(chart, problem)) report["summary"].push_back(problem.name + ": " + line);
    add_work_precision(chart, problem, name, report["charts"]);
    add_histories(problem, name, report["charts"]);
    report["tables"].push_back(points_table(problem, name));
  }
  return report;
}

}  // namespace taut
