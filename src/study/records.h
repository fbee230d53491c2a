#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/residuals.h"
#include "core/result.h"
#include "study/probes.h"

namespace taut {

/// How deep edges and faces are inside a sphere whose constraint holds at vertices only; 0 where none is.
struct Penetration {
  std::string constraint;
  double edge = 0, face = 0;  ///< radius minus the smallest distance from the centre, m
};

using NamedNumbers = std::vector<std::pair<std::string, double>>;

/// A natural frequency and how well its mode is one.
struct ModeRecord {
  double frequency = 0;  ///< Hz
  double residual = 0;   ///< EigenPair::residual
};

/// One line of steps.jsonl: what is known about one step after the judge has looked at it.
struct StepRecord {
  int step = 0;     ///< from 1
  double time = 0;  ///< at its end, s (static: load fraction)
  Status status = Status::solved;
  Status claimed = Status::solved;  ///< by the solver
  std::string message;
  Residuals residuals;  ///< names of nodes are "vertex 3 of cloth"
  std::vector<Penetration> penetrations;
  double objective = 0;    ///< the minimised sum of energies, J
  NamedNumbers energies;   ///< Stepper::energies(), J
  NamedNumbers penalties;  ///< by constraint
  NamedNumbers probes;
  std::vector<ModeRecord> modes;  ///< after the last step, where the scene asks for them
  Counts counts;
  Timings seconds;     ///< the solver's
  double judging = 0;  ///< s
};

/// The largest value that a residual had in any step.
struct Worst {
  double scaled = 0, unscaled = 0;
  int step = 0;
};

/// The largest violation of one constraint in any step, in its own units.
struct WorstViolation {
  std::string constraint;
  double max = 0;
  std::string where;
  int step = 0;                            ///< 0: never violated
  std::optional<Penetration> penetration;  ///< deepest in any step; for spheres
};

/// One element far outside its constraint.
struct WorstElement {
  std::string constraint, element;
  double violation = 0;  ///< in the constraint's own units
};

struct Machine {
  std::string cpu, os;
  int cores = 0;
};

struct RunSeconds {
  double total = 0;  ///< wall clock from start to end, those of resumed parts added
  Timings solver;    ///< sums over the steps
  double judging = 0, output = 0;
};

/// A step that was given up because of a signal or the clock. It is in no file but the summary: a resumed run does it
/// again.
struct UnfinishedStep {
  int step = 0;
  std::string message;
  double stationarity = 0, feasibility = 0, complementarity = 0;  ///< scaled, of the best point so far
};

/// summary.json: how a whole run went.
struct RunSummary {
  std::string input_hash, problem, solver;
  Status status = Status::solved;  ///< interrupted, time_limit, or that of the first step that is not solved
  std::string message;             ///< why it is not solved; empty where it is
  int steps_done = 0, steps_solved = 0, steps_asked = 0;
  double objective = 0;  ///< of the last step, J
  Worst stationarity, feasibility, complementarity;
  double force_scale = 0;  ///< N, of the step with the worst stationarity
  std::string worst_node;  ///< of that step
  std::vector<WorstViolation> violations;
  int worst_elements_step = 0;  ///< the first step that is not solved, or else the last
  std::vector<WorstElement> worst_elements;
  std::optional<UnfinishedStep> unfinished;
  std::vector<ProbeValue> probes;  ///< after the last step
  std::vector<ModeRecord> modes;   ///< as well
  Counts counts;
  RunSeconds seconds;
  std::int64_t peak_memory_bytes = 0;
  std::string version;  ///< of the program that ran
  Machine machine;
  int threads = 0;
  std::vector<std::string> notes;  ///< what went wrong without harm to the result
  std::vector<std::string> files;  ///< relative to the folder; empty where nothing is written
};

/// Takes a finished step into the sums and maxima.
void add_step(RunSummary& summary, const StepRecord& record);

}  // namespace taut
