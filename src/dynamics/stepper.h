#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/problem.h"
#include "core/solver.h"
#include "dynamics/model.h"

namespace taut {

/// How time advances. Each dynamic one is the minimisation of an incremental potential k/2 |x - target|^2_M + E(x),
/// whose gradient is the equation of motion at the end of the step, in newtons; forces, constraints and pins are all
/// taken there.
///
/// - implicit_euler: first order, damps what the step does not resolve.
/// - bdf2: second order, damps less.
/// - generalised_alpha [Chung and Hulbert 1993], in the form of [Arnold and Bruels 2007] that keeps second order with
/// constraints: the equation of
///   motion holds at the end of the step and the blend is in an auxiliary acceleration. spectral_radius = 1 is the
///   average acceleration (trapezoidal) rule: it keeps the energy of free vibrations, but constraint forces then ring
///   from step to step without end.
/// - newmark [Newmark 1959] with any beta > 0 and gamma, in displacements (MW (A.7)-(A.11) divided by beta h^2). Of
/// beta
///   = 1/4, gamma = 1/2, the average acceleration, the remark above holds; the default decays.
/// - quasi_static: no inertia, no damping, no velocities; loads and scripts run with the load fraction from 0 to 1.
///
/// Those of second order start with a step of constant acceleration (Newmark with beta = 1/2, gamma = 1): third-order
/// in position, second-order in velocity, exact in free fall, and it needs no initial acceleration, which constraints
/// that are active at the start would make wrong.
///
/// First order whatever the integrator: loads without a potential (wind), which are held as at the start of the step,
/// and stiffness damping, whose stiffness is that of the start of the step.
enum class Integrator { implicit_euler, bdf2, generalised_alpha, newmark, quasi_static };

struct TimeOptions {
  Integrator integrator = Integrator::implicit_euler;
  double step = 0.01;  ///< s; for quasi_static 1/steps
  int steps = 1;
  double spectral_radius = 0.8;       ///< of generalised alpha at infinite frequency, in [0, 1]
  double beta = 0.3025, gamma = 0.6;  ///< of newmark
  /// Throws std::invalid_argument naming the field.
  void validate() const;
};

/// Everything that changes from step to step, in 64 bits; a run resumed from it ends with the same bits. Vectors have 3
/// entries a vertex.
struct State {
  int step = 0;                                 ///< steps finished
  Vector positions, velocities, accelerations;  ///< m, m/s, m/s^2
  Vector previous_positions,
      previous_velocities;         ///< one step earlier (BDF2); as the present ones before the first step
  Vector auxiliary_accelerations;  ///< generalised alpha: those that advance positions and velocities, m/s^2
  WarmStart warm;                  ///< multipliers and penalties for the solver
};

/// Poses each time step of a model as a Problem and takes its Result back.
class Stepper {
 public:
  /// The model is borrowed and changed (targets of its inertia, factors of its loads, placement of its obstacles).
  /// Throws std::invalid_argument for options or a model that do not fit.
  Stepper(Model& model, TimeOptions options);

  const TimeOptions& options() const { return options_; }
  const State& state() const { return state_; }
  /// Continues from a state that another stepper of the same model has reached. Throws std::invalid_argument where its
  /// sizes do not fit the model.
  void restore(State state);
  /// Time of the present state, s; quasi_static: the load fraction, exactly 1 at the end.
  double time() const { return time_at(state_.step); }

  /// The problem of the next step; the same object every time, with the same topology.
  /// In a static problem `part` of a load step, above 0 and at most 1, will do.
  const Problem& prepare(double part = 1);
  /// Takes the positions of a part of a static load step, from which the next part goes on; no step is finished.
  void hold(const Result& result);
  /// The problem as prepare() has left it.
  const Problem& problem() const { return problem_; }
  /// Takes the positions, multipliers and penalties of the result as the end of the step that prepare() posed.
  void accept(const Result& result);

  /// Energies at the present state, J, by name: "kinetic", then each elastic energy and each load with a potential,
  /// but for end moments, whose potential depends on how often they have turned.
  std::vector<std::pair<std::string, double>> energies() const;

 private:
  /// Acceleration and velocity at the end of the step as functions of the positions x there: a = stiffness (x -
  /// target), v = rate (x - origin).
  struct EndOfStep {
    double stiffness, rate;  // 1/s^2, 1/s
    Vector target, origin;   // m
  };
  EndOfStep end_of_step() const;
  void follow_scripts(EndOfStep& end) const;
  double time_at(int step) const;
  void place(double time);
  bool dynamic() const { return options_.integrator != Integrator::quasi_static; }

  Model& model_;
  TimeOptions options_;
  State state_;
  Problem problem_;
};

}  // namespace taut
