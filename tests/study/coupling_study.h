#pragma once

#include <string>
#include <utility>
#include <vector>

#include "problems/build.h"
#include "problems/read_scene.h"

namespace taut {

/// How far four ways to solve the same coupled steps are apart: the quasi-definite system, penalised rows, the null
/// space, and where it is asked for Ipopt. Each step starts at the state that the first has reached, the others without
/// multipliers.
struct CouplingStudy {
  int steps = 0, unsolved = 0;
  double distance = 0;  ///< largest of any position, over the scene's size
  double coupling = 0;  ///< largest violation of the coupling, over the scene's size

  CouplingStudy(const std::string& problem, Overrides overrides, int step_count, bool with_ipopt) {
    for (const char* residual : {"stationarity", "feasibility", "complementarity"})
      overrides.emplace_back(std::string("solver.tolerance.") + residual, "1e-9");
    std::vector<Overrides> kinds{{}, {{"solver.equalities", "penalised"}}, {{"solver.method", "null_space"}}};
    if (with_ipopt) kinds.push_back({{"solver.method", "ipopt"}});
    for (const Overrides& kind : kinds) {
      Overrides own = overrides;
      own.insert(own.end(), kind.begin(), kind.end());
      ways_.emplace_back(read_scene(std::string(TAUT_CATALOGUE) + "/" + problem + ".json", own));
    }
    for (; steps < step_count; ++steps) step();
  }

 private:
  struct Way {
    Scene scene;
    std::unique_ptr<Model> model;
    Stepper stepper;
    std::unique_ptr<Solver> solver;
    explicit Way(Scene s)
        : scene(std::move(s)),
          model(build_model(scene)),
          stepper(*model, time_options(scene)),
          solver(build_solver(scene, 1)) {}
  };

  void step() {
    const State state = ways_.front().stepper.state();
    Result first;
    for (Way& way : ways_) {
      State start = state;
      if (&way != &ways_.front()) start.warm = {};
      way.stepper.restore(start);
      const Problem& problem = way.stepper.prepare();
      Result result = way.solver->solve(problem, start.warm, {});
      const Residuals judged = residuals(problem, result);
      unsolved += judged.within(way.scene.solver.tolerance) ? 0 : 1;
      const double size = way.model->equalities.front()->violation_scale;
      coupling = std::max(coupling, judged.violations[problem.constraints.size()].max / size);
      if (&way == &ways_.front())
        first = std::move(result);
      else
        distance = std::max(distance, (result.x - first.x).lpNorm<Eigen::Infinity>() / size);
    }
    ways_.front().stepper.restore(state);
    ways_.front().stepper.prepare();
    ways_.front().stepper.accept(first);
  }

  std::vector<Way> ways_;
};

}  // namespace taut
