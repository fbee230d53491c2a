// Whole time steps of scene H, through the same calls as `taut solve` but without judging, files and pictures in the
// measured time. One iteration is a run from the start: 100 steps (one second) up to 64 cells, 30 steps at
// 128 and 10 at 256, where the cloth is still falling and the limit is active near the pins only. Runs are repeatable
// to the last bit, so the counters other than seconds are exact; compare seconds on a quiet machine only.

#include <benchmark/benchmark.h>

#include <algorithm>

#include "benchmarks/scene_h.h"
#include "dynamics/stepper.h"
#include "problems/build.h"
#include "solvers/augmented_lagrangian.h"

namespace taut::benchmarks {
namespace {

struct Totals {
  int steps = 0, solved = 0;
  Counts counts;
  Timings timings;
  double violation = 0, stationarity = 0;

  void add(const Problem& problem, const Result& result) {
    ++steps;
    solved += result.status == Status::solved;
    counts += result.counts;
    timings += result.timings;
    const Residuals judged = residuals(problem, result);
    violation = std::max(violation, judged.feasibility_unscaled);
    stationarity = std::max(stationarity, judged.stationarity);
  }

  /// `ratio` is the whole solve, the analysis of the first step included, over numeric factorisations and solves.
  void report(benchmark::State& state) const {
    const double linear_algebra = timings.factorization + timings.solve;
    state.counters["seconds_per_step"] = timings.total / steps;
    state.counters["newton_per_step"] = static_cast<double>(counts.linear_solves) / steps;
    state.counters["inner_iterations_per_newton"] =
        static_cast<double>(counts.inner_iterations) / static_cast<double>(counts.linear_solves);
    state.counters["evaluations_per_step"] = static_cast<double>(counts.function_evaluations) / steps;
    state.counters["ratio"] = timings.total / linear_algebra;
    state.counters["factor_share"] = timings.factorization / timings.total;
    state.counters["assembly_share"] = timings.assembly / timings.total;
    state.counters["analysis_seconds"] = timings.analysis;
    state.counters["solved"] = static_cast<double>(solved) / steps;
    state.counters["violation"] = violation;
    state.counters["stationarity"] = stationarity;
  }
};

/// Arguments: cells along an edge, threads, central path (1: tried first, 0: multiplier updates only).
void run_steps(benchmark::State& state, Scene scene) {
  const int cells = static_cast<int>(state.range(0)), threads = static_cast<int>(state.range(1));
  scene.solver.central_path = state.range(2) != 0;
  scene.time.steps = cells <= 64 ? 100 : cells <= 128 ? 30 : 10;
  for (auto _ : state) {
    const std::unique_ptr<Model> model = build_model(scene);
    Stepper stepper(*model, time_options(scene));
    const std::unique_ptr<Solver> solver = build_solver(scene, threads);
    Totals totals;
    for (int step = 0; step < scene.time.steps; ++step) {
      const Problem& problem = stepper.prepare();
      const Result result = solver->solve(problem, stepper.state().warm, {});
      totals.add(problem, result);
      stepper.accept(result);
    }
    state.SetIterationTime(totals.timings.total);
    totals.report(state);
    const auto size = dynamic_cast<const AugmentedLagrangian&>(*solver).size();
    state.counters["bytes"] =
        benchmark::Counter(static_cast<double>(size.bytes), benchmark::Counter::kDefaults, benchmark::Counter::kIs1024);
    state.counters["factor_nonzeros"] = size.factor_nonzeros;
  }
}

void scene_h_steps(benchmark::State& state, const Limit& limit) {
  run_steps(state, scene_h(static_cast<int>(state.range(0)), limit));
}

/// Violations within 1e-6 as ever, forces balanced to 1e-4.
void scene_h_violation(benchmark::State& state, const Limit& limit) {
  Scene scene = scene_h(static_cast<int>(state.range(0)), limit);
  scene.solver.tolerance.stationarity = scene.solver.tolerance.complementarity = 1e-4;
  run_steps(state, std::move(scene));
}

void once(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"cells", "threads", "path"})->Iterations(1)->UseManualTime()->Unit(benchmark::kSecond);
}

BENCHMARK_CAPTURE(scene_h_steps, limit_0_9_to_1_1, Limit{0.9, 1.1})
    ->Apply(once)
    ->ArgsProduct({{16, 32, 64, 128, 256}, {1}, {1}})
    ->Args({128, 2, 1})
    ->Args({256, 2, 1})
    ->ArgsProduct({{16, 32}, {1}, {0}});
BENCHMARK_CAPTURE(scene_h_violation, limit_0_9_to_1_1, Limit{0.9, 1.1})->Apply(once)->ArgsProduct({{32, 64}, {1}, {1}});
BENCHMARK_CAPTURE(scene_h_steps, no_limit, Limit{})->Apply(once)->Args({32, 1, 1})->Args({64, 1, 1});
BENCHMARK_CAPTURE(scene_h_steps, limit_to_10, Limit{{}, 10.0})->Apply(once)->Args({32, 1, 1})->Args({64, 1, 1});
BENCHMARK_CAPTURE(scene_h_steps, limit_to_1_1, Limit{{}, 1.1})->Apply(once)->Args({32, 1, 1})->Args({64, 1, 1});
BENCHMARK_CAPTURE(scene_h_steps, limit_to_1_001, Limit{{}, 1.001})->Apply(once)->Args({32, 1, 1})->Args({64, 1, 1});

}  // namespace
}  // namespace taut::benchmarks
