#include "study/solve_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>

#include "core/stopwatch.h"
#include "files/atomic_file.h"
#include "problems/build.h"
#include "problems/nl_problem.h"
#include "study/examine.h"
#include "study/machine.h"
#include "study/records_json.h"

namespace taut {
namespace {

constexpr int worst_elements_kept = 10;

/// A point between the model's start and a random one within the bounds, or around the start where there are none. The
/// first few stay near.
Vector another_start(const NlModel& model, const Vector& start, int number, std::mt19937& random) {
  const auto uniform = [&random] { return static_cast<double>(random()) / static_cast<double>(std::mt19937::max()); };
  const double distance = number <= 3 ? 0.3 : 1;
  Vector x = start;
  for (Index i = 0; i < x.size(); ++i) {
    const double lower = model.lower()[i], upper = model.upper()[i];
    const double reach = std::max(1.0, std::abs(start[i]));
    const double low = std::isfinite(lower) && std::isfinite(upper) ? lower : std::max(lower, start[i] - reach);
    const double high = std::isfinite(lower) && std::isfinite(upper) ? upper : std::min(upper, start[i] + reach);
    x[i] += distance * (low + (high - low) * uniform() - start[i]);
  }
  return x;
}

/// True where a model's result is worth more than another's: solved before unsolved, then by objective; unsolved ones
/// by violation, so that nothing is called infeasible while a point that violates less is known.
bool better(const Problem& problem, const Result& result, const Result& than) {
  const bool solved = result.status == Status::solved;
  if (solved != (than.status == Status::solved)) return solved;
  const auto value = [&](const Result& r) {
    return solved ? objective(problem, r.x) : residuals(problem, r).feasibility;
  };
  const double old = value(than);
  if (!std::isfinite(old)) return std::isfinite(value(result));
  return value(result) < old - 1e-6 * std::max(1.0, std::abs(old));
}

/// Variables above which a solved start is enough: random ones are hardly ever better, and cost as much each.
constexpr Index many_variables = 1000;

/// The best result from the model's start and, so that a nonconvex model has more than one chance, others.
Result solve(const NlModel& model, const Problem& posed, const WarmStart& warm, const Scene& settings,
             const Budget& budget, std::string& solver_name) {
  const std::unique_ptr<Solver> solver = build_solver(settings, 1);
  solver_name = solver->name();
  Result best = solver->solve(posed, warm, budget);
  Counts counts = best.counts;
  Timings timings = best.timings;
  Problem problem = posed;
  std::mt19937 random(1);
  for (int number = 1; number < settings.solver.starts; ++number) {
    if (best.status == Status::solved && problem.size() > many_variables) break;
    if (best.status == Status::unbounded || budget.interrupted() || budget.out_of_time()) break;
    problem.initial_guess = another_start(model, posed.initial_guess, number, random);
    Result result = solver->solve(problem, {}, budget);
    counts += result.counts;
    timings += result.timings;
    if (better(problem, result, best)) best = std::move(result);
  }
  best.counts = counts;
  best.timings = timings;
  return best;
}

}  // namespace

ModelSolution solve_model(const NlModel& model, const Scene& settings, const Budget& budget,
                          const std::string& version) {
  ModelSolution solution;
  RunSummary& summary = solution.summary;
  {
    const Stopwatch watch(summary.seconds.total);
    const NlProblem posed(model);
    const Problem& problem = posed.problem();
    Result result = solve(model, problem, posed.warm(), settings, budget, summary.solver);
    StepRecord record;
    record.step = 1;
    {
      const Stopwatch judging(record.judging);
      record.residuals = residuals(problem, result);
    }
    record.residuals.worst_node = posed.name_of(record.residuals.worst_node);
    if (!problem.fixed_variables.empty()) {
      Violation& fixed = record.residuals.violations.back();  // which the residuals call pins
      fixed.constraint = "fixed variables";
      fixed.where = posed.name_of(fixed.where);
    }
    record.objective = posed.objective(result.x);
    record.status = result.status;
    record.message = result.message;
    if (result.status == Status::solved && !record.residuals.within(settings.solver.tolerance)) {
      record.status = record.residuals.finite ? Status::stalled : Status::not_finite;
      record.message = summary.solver + " says solved, but the residuals are not within tolerance";
    }
    // Rows that push against each other make a scale on which little is left to see.
    const double off = record.residuals.stationarity_unscaled / posed.objective_force(result.x);
    if (record.status == Status::solved && off > settings.solver.tolerance.stationarity)
      summary.notes.push_back(
          fmt::format("stationarity is {:.1e} of the largest force, that of a row, but {:.1e} of the objective's",
                      record.residuals.stationarity, off));
    solution.false_success = record.status != Status::solved && (result.status == Status::solved || result.overruled);
    record.counts = result.counts;
    record.seconds = result.timings;
    summary.steps_asked = 1;
    add_step(summary, record);
    if (record.status != Status::solved) summary.message = record.message;  // there is no other step to tell it from
    summary.worst_elements = worst_elements(problem, result.x, worst_elements_kept);
    summary.worst_elements_step = 1;
    solution.dual = posed.dual(result);
    solution.x = std::move(result.x);
  }
  summary.problem = model.name();
  summary.input_hash = settings.hash;
  summary.version = version;
  summary.machine = this_machine();
  summary.threads = 1;
  summary.peak_memory_bytes = peak_memory_bytes();
  return solution;
}

void write_model_solution(const std::filesystem::path& folder, const NlModel& model, ModelSolution& solution) {
  using Json = nlohmann::ordered_json;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError(folder, "cannot be made: " + error.message());
  Json variables = Json::object(), rows = Json::object();
  for (int i = 0; i < model.variables(); ++i) variables[model.variable_name(i)] = solution.x[i];
  for (int row = 0; row < model.rows(); ++row)
    rows[model.row_name(row)] = {{"value", model.value_at(row, solution.x)}, {"multiplier", solution.dual[row]}};
  solution.summary.files = {"solution.json"};
  write_atomically(
      folder / "solution.json",
      Json{{"objective", solution.summary.objective}, {"variables", variables}, {"rows", rows}}.dump(2) + "\n");
  write_atomically(folder / "summary.json", summary_text(solution.summary));
}

}  // namespace taut
