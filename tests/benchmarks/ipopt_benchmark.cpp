// The default solver beside Ipopt on the same steps of scene H: both start from the same states and are judged alike.
// At 32 cells Ipopt takes minutes for a few steps, so a handful is timed, in the fall while the limit becomes active.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <iterator>

#include "benchmarks/scene_h.h"
#include "problems/build.h"
#include "study/compare_records.h"

namespace taut::benchmarks {
namespace {

EntryRun solve_steps(const Scene& scene, const std::vector<State>& states) {
  const auto solver = build_solver(scene, 1);
  EntryRun run;
  run.trials = compare_steps(scene, states, *solver);
  return run;
}

double seconds(const EntrySummary& summary) { return summary.seconds.median; }

/// Arguments: cells along an edge, first and last step.
void beside_ipopt(benchmark::State& state, const Limit& limit) {
  const int first = static_cast<int>(state.range(1)), last = static_cast<int>(state.range(2));
  Scene scene = scene_h(static_cast<int>(state.range(0)), limit);
  scene.time.steps = last;
  std::vector<State> states = states_of(scene, last);
  states.erase(states.begin(), std::next(states.begin(), first - 1));
  Scene other = scene;
  other.solver.method = scene::SolverMethod::ipopt;
  for (auto _ : state) {
    const EntrySummary ours = summarize(solve_steps(scene, states)), theirs = summarize(solve_steps(other, states));
    state.SetIterationTime(seconds(ours) * (last - first + 1));
    state.counters["seconds_per_step"] = seconds(ours);
    state.counters["ipopt_seconds_per_step"] = seconds(theirs);
    state.counters["ipopt_over_ours"] = seconds(theirs) / seconds(ours);
    state.counters["solved"] = ours.solved;
    state.counters["ipopt_solved"] = theirs.solved;
    state.counters["residual"] = ours.residual;
    state.counters["ipopt_residual"] = theirs.residual;
  }
}

BENCHMARK_CAPTURE(beside_ipopt, limit_0_9_to_1_1, Limit{0.9, 1.1})
    ->ArgNames({"cells", "first", "last"})
    ->Args({16, 21, 40})
    ->Args({32, 31, 35})
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace taut::benchmarks
