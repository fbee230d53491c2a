#include "study/solve_model.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

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

/// Of a model without any variable that is free and bounded by something, the solvers know nothing.
Result solve(const Problem& problem, const Scene& settings, const Budget& budget, std::string& solver_name) {
  const std::unique_ptr<Solver> solver = build_solver(settings, 1);
  solver_name = solver->name();
  return solver->solve(problem, {}, budget);
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
    Result result = solve(problem, settings, budget, summary.solver);
    StepRecord record;
    record.step = 1;
    {
      const Stopwatch judging(record.judging);
      record.residuals = residuals(problem, result);
    }
    record.residuals.worst_node = posed.name_of(record.residuals.worst_node);
    record.objective = posed.objective(result.x);
    record.status = result.status;
    record.message = result.message;
    if (result.status == Status::solved && !record.residuals.within(settings.solver.tolerance)) {
      record.status = record.residuals.finite ? Status::stalled : Status::not_finite;
      record.message = summary.solver + " says solved, but the residuals are not within tolerance";
    }
    record.counts = result.counts;
    record.seconds = result.timings;
    summary.steps_asked = 1;
    add_step(summary, record);
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
  for (int row = 0; row < model.rows(); ++row) {
    Vector own(static_cast<Index>(model.variables_of(row).size()));
    for (Index k = 0; k < own.size(); ++k) own[k] = solution.x[model.variables_of(row)[static_cast<std::size_t>(k)]];
    rows[model.row_name(row)] = {{"value", model.evaluate(row, own.data(), nullptr, nullptr)},
                                 {"multiplier", solution.dual[row]}};
  }
  solution.summary.files = {"solution.json"};
  write_atomically(
      folder / "solution.json",
      Json{{"objective", solution.summary.objective}, {"variables", variables}, {"rows", rows}}.dump(2) + "\n");
  write_atomically(folder / "summary.json", summary_text(solution.summary));
}

}  // namespace taut
