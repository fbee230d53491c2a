// A Newton iteration of a fine membrane on a coarse thick shell (assembly, factorisation, solve with refinement), by
// each way to hold the coupling, against the same two bodies without it. Arguments: cells of the shell along an edge,
// refinements of the cover. Compare seconds on a quiet machine only; nonzeros and flops are exact.

#include <benchmark/benchmark.h>

#include "dynamics/stepper.h"
#include "problems/build.h"
#include "problems/read_scene.h"
#include "solvers/equality_system.h"
#include "solvers/null_space_system.h"

namespace taut::benchmarks {
namespace {

enum class Way { uncoupled, quasi_definite, penalised, null_space };

/// The first step of the quilt, without its strain limit.
struct Quilt {
  std::unique_ptr<Model> model;
  std::unique_ptr<Stepper> stepper;
  Problem problem;

  Quilt(long cells, long levels, bool null_space) {
    const std::string side = std::to_string(cells);
    const Scene scene = read_scene(TAUT_CATALOGUE "/quilt.json",
                                   {{"bodies.quilt.mesh.grid.cells", "[" + side + ", " + side + "]"},
                                    {"bodies.quilt.cover.mesh.refine", std::to_string(levels)},
                                    {"solver.method", null_space ? "null_space" : "augmented_lagrangian"}});
    model = build_model(scene);
    stepper = std::make_unique<Stepper>(*model, time_options(scene));
    problem = stepper->prepare();
    problem.constraints.clear();
  }
};

void newton_iteration(benchmark::State& state, Way way) {
  Quilt quilt(state.range(0), state.range(1), way == Way::null_space);
  const Problem& problem = quilt.problem;
  const EqualityRows equalities = way == Way::uncoupled ? EqualityRows() : EqualityRows(problem);
  const std::vector<int> none, &fixed = way == Way::null_space ? none : problem.fixed_variables;
  Assembly assembly(problem.size(), problem.energies, fixed, 1);
  std::unique_ptr<Cholesky> cholesky;
  std::unique_ptr<NewtonSystem> system;
  switch (way) {
    case Way::uncoupled:
      assembly.set_order(fill_reducing_order(assembly.graph()));
      cholesky = std::make_unique<Cholesky>(assembly.matrix(), 1);
      system = std::make_unique<SubstitutedSystem>(assembly, *cholesky);
      break;
    case Way::quasi_definite:
      system = std::make_unique<QuasiDefiniteSystem>(assembly, equalities, fixed);
      break;
    case Way::penalised:
      system = std::make_unique<PenalisedRowsSystem>(assembly, equalities, fixed, 1);
      break;
    case Way::null_space:
      system = std::make_unique<NullSpaceSystem>(assembly, equalities, problem);
      break;
  }
  Vector gradient, violation, step, multipliers;
  equalities.violation(problem.initial_guess, violation);
  for (auto _ : state) {
    assembly.hessian(problem.initial_guess, Curvature::positive_semidefinite, &gradient);
    for (const int variable : problem.fixed_variables) gradient[variable] = 0;
    if (!system->factorize(0)) state.SkipWithError("not positive definite");
    system->solve(gradient, violation, step, multipliers);
  }
  const NewtonSystem::Size size = system->size();
  state.counters["unknowns"] = static_cast<double>(problem.size());
  state.counters["factor_nonzeros"] = size.factor_nonzeros;
  state.counters["factor_flops"] = size.factor_flops;
  state.counters["bytes"] =
      benchmark::Counter(static_cast<double>(size.bytes), benchmark::Counter::kDefaults, benchmark::Counter::kIs1024);
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"cells", "refine"})->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(newton_iteration, uncoupled, Way::uncoupled)->Apply(sizes)->ArgsProduct({{8}, {1, 2, 3, 4}});
BENCHMARK_CAPTURE(newton_iteration, quasi_definite, Way::quasi_definite)
    ->Apply(sizes)
    ->ArgsProduct({{8}, {1, 2, 3, 4}});
BENCHMARK_CAPTURE(newton_iteration, penalised, Way::penalised)->Apply(sizes)->ArgsProduct({{8}, {1, 2, 3}});
BENCHMARK_CAPTURE(newton_iteration, null_space, Way::null_space)
    ->Apply(sizes)
    ->ArgsProduct({{8}, {1, 2, 3}})
    ->Iterations(1);

}  // namespace
}  // namespace taut::benchmarks
