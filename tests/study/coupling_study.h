#pragma once

#include <string>
#include <utility>
#include <vector>

#include "problems/build.h"
#include "problems/read_scene.h"
#include "study/solver_entries.h"

namespace taut {

/// How far several ways to solve the same coupled steps are apart: the default, and entries of `taut compare`. Each
/// step starts at the state that the default has reached, the others without its multipliers.
struct CouplingStudy {
  int steps = 0, unsolved = 0;
  double distance = 0;    ///< largest of any position, over the scene's size
  double coupling = 0;    ///< largest violation of the coupling, over the scene's size
  double worst = 0;       ///< largest residual of any kind
  long active_steps = 0;  ///< in which some constraint has a multiplier

  CouplingStudy(const std::string& problem, Overrides overrides, int step_count, const std::vector<std::string>& others,
                const std::string& tolerance = "1e-9") {
    for (const char* residual : {"stationarity", "feasibility", "complementarity"})
      overrides.emplace_back(std::string("solver.tolerance.") + residual, tolerance);
    std::vector<Overrides> kinds{{}};
    for (const std::string& other : others) kinds.push_back(solver_entry(other).overrides);
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
      worst = std::max({worst, judged.stationarity, judged.feasibility, judged.complementarity});
      const double size = way.model->equalities.front()->violation_scale;
      coupling = std::max(coupling, judged.violations[problem.constraints.size()].max / size);
      if (&way != &ways_.front()) {
        distance = std::max(distance, (result.x - first.x).lpNorm<Eigen::Infinity>() / size);
        continue;
      }
      first = std::move(result);
      bool active = false;
      for (std::size_t k = 0; k < problem.constraints.size(); ++k) active = active || !first.multipliers[k].isZero(0);
      active_steps += active ? 1 : 0;
    }
    ways_.front().stepper.restore(state);
    ways_.front().stepper.prepare();
    ways_.front().stepper.accept(first);
  }

  std::vector<Way> ways_;
};

}  // namespace taut
