#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "problems/build.h"
#include "problems/read_scene.h"
#include "study/compare_records.h"

namespace taut {

/// Solves the same steps of a catalogue problem by several methods, each from the same states, at a tolerance of 1e-9.
class CrossCheck {
 public:
  CrossCheck(const std::string& problem, Overrides overrides, int steps) {
    const std::string file = std::string(TAUT_CATALOGUE) + "/" + problem + ".json";
    const Scene reference = read_scene(file, overrides);
    states_ = states_of(reference, steps);
    for (const char* residual : {"stationarity", "feasibility", "complementarity"})
      overrides.emplace_back(std::string("solver.tolerance.") + residual, "1e-9");
    for (const char* method : {"augmented_lagrangian", "null_space", "ipopt"}) {
      Overrides own = overrides;
      own.emplace_back("solver.method", method);
      const Scene scene = read_scene(file, own);
      const auto solver = build_solver(scene, 1);
      EntryRun run;
      run.label = method;
      run.steps_asked = static_cast<int>(states_.size());
      run.trials = compare_steps(scene, states_, *solver);
      runs_.push_back(std::move(run));
    }
    const Vector& start = states_.front().positions;
    const Eigen::Map<const Eigen::Matrix3Xd> vertices(start.data(), 3, start.size() / 3);
    const double size = (vertices.rowwise().maxCoeff() - vertices.rowwise().minCoeff()).norm();
    // As in `taut compare`, distances are from the tightest-converged of those within the problem's own tolerance:
    // nearly inextensible cloth has steps that no method takes to 1e-9.
    measure_distances(runs_, reference.solver.tolerance, size,
                      [this](std::size_t run, std::size_t trial) { return runs_[run].trials[trial].result.x; });
  }

  int steps() const { return static_cast<int>(states_.size()); }
  const std::vector<EntryRun>& runs() const { return runs_; }
  /// The largest difference of a multiplier between the first method and another, relative to the step's largest.
  double multiplier_difference(std::size_t run, std::size_t step) const {
    const auto &first = runs_.front().trials[step].result.multipliers,
               &other = runs_[run].trials[step].result.multipliers;
    double difference = 0, largest = 0;
    for (std::size_t k = 0; k < first.size(); ++k) {
      difference = std::max(difference, (first[k] - other[k]).cwiseAbs().maxCoeff());
      largest = std::max(largest, first[k].cwiseAbs().maxCoeff());
    }
    return largest > 0 ? difference / largest : difference;
  }

 private:
  std::vector<State> states_;
  std::vector<EntryRun> runs_;
};

}  // namespace taut
