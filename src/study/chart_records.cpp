#include "study/chart_records.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "study/pareto.h"
#include "study/richardson.h"

namespace taut {
namespace {

/// A row per problem and value, a column per solver; infinity where the run is not correct.
template <class Cost>
Matrix costs_of(const ChartData& chart, const Cost& cost) {
  const auto solvers = static_cast<Index>(chart.solvers.size());
  std::vector<Vector> rows;
  for (const ProblemChart& problem : chart.problems) {
    const std::size_t values = problem.points.size() / chart.solvers.size();
    for (std::size_t value = 0; value < values; ++value) {
      Vector& row = rows.emplace_back(solvers);
      for (Index solver = 0; solver < solvers; ++solver) {
        const ChartPoint& point = problem.points[static_cast<std::size_t>(solver) * values + value];
        row[solver] = is_correct(point, chart.accuracy) ? cost(point) : std::numeric_limits<double>::infinity();
      }
    }
  }
  Matrix costs(static_cast<Index>(rows.size()), solvers);
  for (std::size_t k = 0; k < rows.size(); ++k) costs.row(static_cast<Index>(k)) = rows[k];
  return costs;
}

}  // namespace

std::string_view to_string(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::position:
      return "position";
    case ErrorKind::energy:
      return "energy";
    case ErrorKind::probe:
      return "probe";
    case ErrorKind::violation:
      return "violation";
  }
  throw std::invalid_argument("to_string: not an ErrorKind");
}

bool is_correct(const ChartPoint& point, double accuracy) {
  return point.solved() && (!point.error || *point.error <= accuracy);
}

void mark_front(std::vector<ChartPoint>& points) {
  std::vector<WorkPrecision> work;
  for (ChartPoint& point : points) {
    point.on_front = false;
    const bool counts = point.solved() && point.error;
    work.push_back({point.solver_seconds, counts ? *point.error : std::numeric_limits<double>::quiet_NaN()});
  }
  for (const std::size_t k : pareto_front(work)) points[k].on_front = true;
}

const ChartPoint* cheapest_below(const std::vector<ChartPoint>& points, double error) {
  const ChartPoint* cheapest = nullptr;
  for (const ChartPoint& point : points) {
    if (!point.solved() || !point.error || *point.error > error) continue;
    if (!cheapest || point.solver_seconds < cheapest->solver_seconds) cheapest = &point;
  }
  return cheapest;
}

std::optional<double> order_of(const std::vector<ChartPoint>& points, const std::string& solver, double floor) {
  std::vector<double> sizes, errors;
  for (const ChartPoint& point : points) {
    if (point.solver != solver || !point.solved() || !point.error || !(*point.error > floor)) continue;
    sizes.push_back(point.number);
    errors.push_back(*point.error);
  }
  return observed_order(sizes, errors);
}

std::vector<SolverScore> scores_of(const ChartData& chart) {
  std::vector<SolverScore> scores;
  for (const std::string& solver : chart.solvers) {
    SolverScore& score = scores.emplace_back();
    score.solver = solver;
    std::vector<double> seconds;
    for (const ProblemChart& problem : chart.problems) {
      for (const ChartPoint& point : problem.points) {
        if (point.solver != solver) continue;
        ++score.runs;
        score.false_successes += point.false_successes > 0;
        score.solved += point.solved();
        const bool correct = is_correct(point, chart.accuracy);
        score.correct += correct;
        seconds.push_back(correct ? point.solver_seconds : chart.max_seconds);
      }
    }
    if (!seconds.empty()) score.mean_seconds = shifted_geometric_mean(seconds, mean_shift);
  }
  return scores;
}

ChartProfiles profiles_of(const ChartData& chart) {
  // A clock or a count of zero would have no logarithm.
  const Matrix seconds = costs_of(chart, [](const ChartPoint& point) { return std::max(point.solver_seconds, 1e-9); });
  const Matrix solves = costs_of(chart, [](const ChartPoint& point) {
    return static_cast<double>(std::max(point.counts.linear_solves, 1L)) / std::max(point.steps_asked, 1);
  });
  return {performance_profiles(seconds), data_profiles(solves)};
}

}  // namespace taut
