#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/solver.h"
#include "dynamics/stepper.h"
#include "problems/scene.h"
#include "study/records.h"

namespace taut {

/// How far a solution is from the reference solution of its step.
struct Distance {
  double positions = 0;   ///< largest distance of a vertex, relative to the size of the scene
  double objective = 0;   ///< |f - f_ref| / max(|f_ref|, |f(x0) - f_ref|), x0 the initial guess
  std::string reference;  ///< label of the entry whose solution it is
};

/// What a solver made of one step, and what the judge says to that.
struct StepTrial {
  int step = 0;                    ///< from 1
  Result result;                   ///< of the first repeat; its status is what the solver claims
  Status judged = Status::solved;  ///< `solved` exactly where the residuals are within tolerance
  Residuals residuals;             ///< names of nodes are "vertex 3 of cloth"
  std::vector<WorstElement> worst_elements;
  double objective = 0, objective_at_start = 0;  ///< at the result and at the initial guess, J
  std::string warm_start;              ///< where the multipliers it began with came from: "state", "own" or "none"
  std::vector<double> seconds;         ///< wall clock of solve(), one per repeat
  double warm_up_seconds = 0;          ///< of the untimed solve before the first step; 0 for the others
  std::int64_t peak_memory_bytes = 0;  ///< of the process, up to this step
  std::optional<Distance> distance;    ///< set by measure_distances()

  /// The solver says solved, the residuals do not.
  bool false_success() const { return result.status == Status::solved && judged != Status::solved; }
};

struct TrialOptions {
  int repeat = 1;       ///< how often each step is solved and timed
  bool cold = false;    ///< no multipliers and penalties from the state
  bool warm_up = true;  ///< solve the first step once before anything is timed
  Budget budget = {};
};

/// Lets one solver solve time steps of a scene from given states, times it, and judges what it returns.
///
/// Before the first step, that step is (if options.warm_up) solved once without being timed, so that ordering, symbolic
/// factor and cold caches are in nobody's times. Where the multipliers of a state do not fit the scene (they are of
/// another form of a limit), those of the solver's own step before, if it was solved, take their place.
class StepTrials {
 public:
  /// Scene and solver are borrowed. Throws InputError for a scene that cannot be built, std::invalid_argument for a
  /// repeat below 1.
  StepTrials(const Scene& scene, Solver& solver, TrialOptions options = {});
  ~StepTrials();

  /// The state that the scene starts from, or that accept() has reached.
  const State& state() const;
  const Model& model() const { return *model_; }
  /// The step that follows `state`. Throws std::invalid_argument where the state's sizes do not fit the scene.
  StepTrial run(const State& state);
  /// Takes the latest result as the end of its step; state() is then the next one to run from.
  void accept();

 private:
  std::string choose_warm_start(const Problem& problem, WarmStart& warm) const;
  void judge(const Problem& problem, StepTrial& trial) const;

  const Scene& scene_;
  Solver& solver_;
  TrialOptions options_;
  std::unique_ptr<Model> model_;
  std::unique_ptr<Stepper> stepper_;
  bool warmed_up_ = false, latest_solved_ = false;
  Result latest_;
};

/// The states before each of the first `steps` steps, as the solver that the scene names reaches them; fewer where it
/// does not solve one (the state before that one is the last).
std::vector<State> states_of(const Scene& scene, int steps);

/// Lets any solver solve the steps that follow these states, in this process: how a solver of one's own is compared.
std::vector<StepTrial> compare_steps(const Scene& scene, const std::vector<State>& states, Solver& solver,
                                     const TrialOptions& options = {});

}  // namespace taut
