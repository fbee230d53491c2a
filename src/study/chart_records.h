#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "study/chart_knob.h"
#include "study/history.h"
#include "study/profiles.h"
#include "study/records.h"

namespace taut {

/// What the error of a point is measured in; see docs/guide/chart.md.
enum class ErrorKind {
  position,  ///< largest distance of a common vertex at the end, over the diagonal of the scene
  energy,    ///< difference of the sum of energies at the end, over the sum of their magnitudes
  probe,     ///< largest difference of a probe at the end, over its scale
  violation  ///< largest scaled violation of any step
};
std::string_view to_string(ErrorKind kind);

/// One run of one solver at one value of the knob.
struct ChartPoint {
  std::string solver, value;                                 ///< label of solver_entries(), KnobValue::label
  double number = std::numeric_limits<double>::quiet_NaN();  ///< KnobValue::number
  std::vector<std::string> command;                          ///< the words that solve the same again
  std::string folder;                                        ///< relative to the chart's
  /// "finished", "time_limit", "out_of_memory", "crash: SIGSEGV", "error", "interrupted"
  std::string outcome = "interrupted";
  std::string status = "interrupted";  ///< the judge's of the run, or the outcome where there is none
  std::string message;                 ///< why it is not solved
  bool resumed = false;                ///< taken over from an earlier chart
  int steps_asked = 0, steps_done = 0, steps_solved = 0;
  int false_successes = 0;                 ///< steps that the solver called solved and the judge does not
  double seconds = 0, solver_seconds = 0;  ///< of the whole run by the clock, of the solver alone
  Counts counts;
  std::int64_t peak_memory_bytes = 0;
  double violation = 0;  ///< largest scaled one of any step
  NamedNumbers probes;   ///< after the last step
  std::optional<double> error;
  bool on_front = false;

  bool solved() const { return status == "solved"; }
};

/// What errors are measured against.
struct ChartReference {
  std::string group;  ///< KnobValue::label where each value poses another problem, else empty
  /// "closed form", "extrapolation", "solution", "none needed", or "missing"
  std::string kind = "missing";
  std::string text = "not solved before the chart was interrupted";  ///< what it is
  std::string solver;                                                ///< of a solution
  std::vector<std::string> not_independent_of;                       ///< charted solvers that are of the same method
  std::optional<double> estimated_error;                             ///< in the unit of the errors
  std::optional<double> order;                                       ///< of an extrapolation
  std::vector<ChartPoint> runs;  ///< all that were tried, the finest of each solver first
};

/// Convergence within one step.
struct ChartHistory {
  ChartPoint run;
  int step = 0;
  std::vector<HistoryPoint> points;
};

struct ProblemChart {
  std::string name, problem, folder;  ///< `problem` as it was given; `folder` relative to the chart's
  ErrorKind error = ErrorKind::position;
  double size = 0;  ///< diagonal of the bounding box at the start, m
  std::vector<ChartReference> references;
  std::vector<ChartPoint> points;  ///< solver by solver, each in the order of the values
  std::vector<ChartHistory> histories;
};

struct ChartData {
  KnobChoice knob;
  std::vector<std::string> solvers;
  std::vector<ProblemChart> problems;
  double max_seconds = 0;  ///< of each run
  double accuracy = 0;     ///< error up to which a solved point counts as correct
  bool interrupted = false;
  int threads = 1;
  std::string version;
  Machine machine;
};

/// Judged solved, and with an error of at most `accuracy` where it has one.
bool is_correct(const ChartPoint& point, double accuracy);

/// Sets ChartPoint::on_front by solver seconds and error, solved points only.
void mark_front(std::vector<ChartPoint>& points);

/// The solved point with an error of at most `error` that took the solver least time; null where there is none.
const ChartPoint* cheapest_below(const std::vector<ChartPoint>& points, double error);

/// The order in which the errors of a solver's solved points fall with their number, above `floor`.
std::optional<double> order_of(const std::vector<ChartPoint>& points, const std::string& solver, double floor);

/// How a solver did over all problems and values.
struct SolverScore {
  std::string solver;
  int runs = 0, false_successes = 0, correct = 0, solved = 0;  ///< runs
  double mean_seconds = 0;  ///< shifted geometric mean of the solver's seconds; what is not correct counts max_seconds
};
/// Seconds that are added before the mean is taken.
inline constexpr double mean_shift = 1;
std::vector<SolverScore> scores_of(const ChartData& chart);

struct ChartProfiles {
  std::vector<Profile> performance;  ///< by solver; cost: the solver's seconds
  std::vector<Profile> data;         ///< by solver; cost: linear solves a step
};
/// Of the correct runs, with a problem at one value of the knob as an instance.
ChartProfiles profiles_of(const ChartData& chart);

}  // namespace taut
