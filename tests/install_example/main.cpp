#include <cstdio>

#include "problems/build.h"
#include "problems/read_scene.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s PROBLEM.json\n", argv[0]);
    return 2;
  }
  const taut::Scene scene = taut::read_scene(argv[1], {{"time.steps", "5"}});
  const auto model = taut::build_model(scene);
  const auto solver = taut::build_solver(scene, 1);
  taut::Stepper stepper(*model, taut::time_options(scene));

  for (int step = 1; step <= scene.time.steps; ++step) {
    const taut::Problem& problem = stepper.prepare();
    const taut::Result result = solver->solve(problem, stepper.state().warm, {});
    const taut::Residuals residuals = taut::residuals(problem, result);
    stepper.accept(result);

    std::printf("t = %.3f s: stationarity %.1e, feasibility %.1e, complementarity %.1e\n", stepper.time(),
                residuals.stationarity, residuals.feasibility, residuals.complementarity);
    for (const taut::Violation& violation : residuals.violations) {
      if (violation.max > 0)
        std::printf("  %s: %.1e at %s\n", violation.constraint.c_str(), violation.max, violation.where.c_str());
    }
    if (!residuals.within(scene.solver.tolerance)) return 3;
  }
  return 0;
}
