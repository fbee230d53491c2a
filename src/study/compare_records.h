#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "problems/read_scene.h"
#include "study/records.h"
#include "study/step_trial.h"

namespace taut {

/// What one entry of a comparison made of one problem: a solver with its variations and tolerance, in one process.
struct EntryRun {
  std::string label;   ///< "ipopt form=matrix tol=1e-08"
  std::string solver;  ///< "ipopt"
  std::string group;   ///< entries of one group solve the same problem, so that their solutions have a distance
  Overrides overrides;
  Tolerances tolerance;
  int steps_asked = 0;
  /// "finished", "time_limit", "out_of_memory", "crash: SIGSEGV", "error", "refused", "no_states",
  /// "interrupted"
  std::string outcome = "finished";
  std::string message;  ///< why it is not finished
  double seconds = 0;   ///< wall clock of the process
  std::int64_t peak_memory_bytes = 0;
  bool resumed = false;   ///< taken over from an earlier comparison
  std::string folder;     ///< relative to that of the comparison
  bool on_front = false;  ///< see mark_front()
  std::vector<StepTrial> trials;
};

/// Median and range over the repeats.
struct Spread {
  double median = 0, min = 0, max = 0;
};
/// Throws std::invalid_argument for no values.
Spread spread_of(std::vector<double> values);

/// The headline of an entry. All maxima are over its steps; NaN is larger than everything.
struct EntrySummary {
  int solved = 0, false_successes = 0;
  std::map<std::string, int> failures;  ///< number of steps by judged status; by outcome for those never tried
  double residual = 0;                  ///< largest of the three scaled residuals
  double position_distance = 0, objective_distance = 0;
  int distances = 0;         ///< steps that have a distance
  Spread seconds;            ///< mean per step, over the repeats
  double linear_solves = 0;  ///< mean per step
};
EntrySummary summarize(const EntryRun& run);

struct ProblemComparison {
  std::string name, file, hash;
  std::string folder;   ///< relative to that of the comparison
  EntryRun trajectory;  ///< gave the states; no trials where every entry follows its own
  bool trajectory_solved = true;
  int steps_asked = 0;
  double size = 0;  ///< diagonal of the scene's bounding box at the start, m
  std::vector<EntryRun> entries;
};

struct Comparison {
  std::vector<ProblemComparison> problems;
  bool free = false, cold = false, interrupted = false;
  int repeat = 1, threads = 1;
  double time_limit = 0;                ///< s, of each process
  std::int64_t memory_limit_bytes = 0;  ///< of each process
  std::string version;
  Machine machine;
};

/// The positions that an entry reached in a trial, both given by their place.
using PositionsOf = std::function<Vector(std::size_t entry, std::size_t trial)>;

/// Sets StepTrial::distance. The reference solution of a step is the tightest-converged one of all entries of the
/// group: that whose largest residual, in units of `tolerance`, is smallest, among those within `tolerance`. Steps
/// without such a solution get no distance. `size` is that of the scene, m.
void measure_distances(std::vector<EntryRun>& entries, const Tolerances& tolerance, double size,
                       const PositionsOf& positions);

/// Sets EntryRun::on_front: of the entries of a group that solved every step, those that no other beats in seconds a
/// step without being farther from the reference solutions, or the reverse. Needs the distances.
void mark_front(std::vector<EntryRun>& entries);

}  // namespace taut
