#include <cstdio>
#include <deque>
#include <string>
#include <vector>

#include "linalg/cholesky.h"
#include "problems/build.h"
#include "problems/read_scene.h"
#include "solvers/eliminated_slack.h"
#include "solvers/newton.h"
#include "study/compare_records.h"

/// A penalty method: minimises f + mu/2 dist(c(x), K)^2 once, and believes that this is enough.
class PenaltyMethod final : public taut::Solver {
 public:
  std::string name() const override { return "penalty"; }

  taut::Result solve(const taut::Problem& problem, const taut::WarmStart&, const taut::Budget& budget) override {
    std::deque<taut::EliminatedSlack> slacks;
    std::vector<const taut::Energy*> terms = problem.energies;
    for (const taut::Constraint* constraint : problem.constraints) {
      slacks.emplace_back(*constraint).set_penalty(1e3);
      terms.push_back(&slacks.back());
    }
    taut::Assembly assembly(problem.size(), terms, problem.fixed_variables, 1);
    assembly.set_order(taut::fill_reducing_order(assembly.graph()));
    taut::Cholesky cholesky(assembly.matrix(), 1);
    taut::SubstitutedSystem system(assembly, cholesky);
    taut::Newton newton(assembly, system, problem.fixed_variables, problem.node_size, {});

    taut::Result result;
    taut::NewtonState state;
    state.x = problem.initial_guess;
    result.status = newton.minimise(
        state, [](const taut::NewtonState& now) { return now.nodal_norm < 1e-10; }, budget, result.counts,
        result.timings);
    result.x = state.x;
    for (const taut::EliminatedSlack& slack : slacks) {
      slack.updated_multipliers(state.x, 1e300, result.multipliers.emplace_back());
    }
    return result;
  }
};

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s PROBLEM.json\n", argv[0]);
    return 2;
  }
  const taut::Scene scene = taut::read_scene(argv[1], {{"time.steps", "30"}});
  PenaltyMethod own;
  const auto usual = taut::build_solver(scene, 1);
  const auto states = taut::states_of(scene, scene.time.steps);
  for (taut::Solver* solver : {usual.get(), static_cast<taut::Solver*>(&own)}) {
    taut::EntryRun run;
    run.trials = taut::compare_steps(scene, states, *solver);
    const taut::EntrySummary summary = taut::summarize(run);
    std::printf("%s: %d solved, %d false successes, residual %.0e\n", solver->name().c_str(), summary.solved,
                summary.false_successes, summary.residual);
  }
  return 0;
}
