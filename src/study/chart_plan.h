#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/chart_errors.h"
#include "study/chart_run.h"

namespace taut {

/// The file that a problem's name or path means. Throws where there is none.
using FindProblem = std::function<std::filesystem::path(const std::string&)>;

/// What is charted.
struct ChartChoice {
  std::vector<std::string> problems;  ///< names or paths, as FindProblem takes them
  std::vector<std::string> solvers;   ///< labels of solver_entries()
  std::string reference;              ///< label of the solver of references; empty: the first that solves them
  KnobChoice knob;
  std::optional<ErrorKind> error;  ///< none: probes where they have a closed form, else positions
  Overrides settings;              ///< of every run
  int history_step = -1;           ///< of one run per solver; 0: none, -1: the last step
};

struct PlannedRun {
  ChartJob job;
  std::string value;              ///< KnobValue::label, or that of a rung
  std::vector<BodyPoint> points;  ///< what position errors compare
};

/// The solutions of a reference, of which the finest has to be found and the others tell its error.
struct ReferenceLadder {
  std::string solver;
  double tolerance = 0;
  std::vector<PlannedRun> rungs;  ///< finest first
};

struct PlannedReference {
  std::string group;                     ///< ChartReference::group
  std::vector<ReferenceLadder> ladders;  ///< to be tried in this order; none where no solution is needed
  bool refines = false;                  ///< rungs differ in step or mesh by a factor of 2 each, else in tolerance
};

struct ChartPlan {
  std::string problem;
  Scene scene;  ///< as the first solver takes it, at no value of the knob
  ErrorMeasure measure;
  std::vector<KnobValue> values;
  std::vector<PlannedRun> runs;  ///< solver by solver
  std::vector<PlannedReference> references;
  std::vector<PlannedRun> histories;  ///< one per solver, or none
};

/// Reads and builds everything that will be run, so that whatever is wrong is known before. Throws InputError.
ChartPlan plan_chart(const std::string& problem, const ChartChoice& choice, const FindProblem& find);

/// Solvers of one method differ in details only: "augmented_lagrangian" and its variants, the null space among them.
std::string method_of(const std::string& solver);

}  // namespace taut
