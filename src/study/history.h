#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "core/solver.h"

namespace taut {

/// One iterate of a solver, judged like a result.
struct HistoryPoint {
  long linear_solves = 0;                                         ///< in this solve so far
  double seconds = 0;                                             ///< of the solver, judging left out
  double stationarity = 0, feasibility = 0, complementarity = 0;  ///< scaled, as in Residuals
  double penalty = 0;                                             ///< Iterate::penalty
};

/// Watches a solver from its construction to its destruction and judges every iterate it shows. Both arguments are
/// borrowed; the solver's observer is replaced.
class History {
 public:
  History(Solver& solver, const Problem& problem);
  ~History();
  History(const History&) = delete;
  History& operator=(const History&) = delete;

  /// Empty for a solver that shows no iterates.
  const std::vector<HistoryPoint>& points() const { return points_; }

 private:
  void take(const Iterate& iterate);

  Solver& solver_;
  const Problem& problem_;
  std::chrono::steady_clock::time_point start_;
  double judging_ = 0;  // s
  std::vector<HistoryPoint> points_;
};

/// history.csv, a line per iterate; numbers that are not finite become "nan" and "inf".
std::string history_csv(const std::vector<HistoryPoint>& points);
/// Reads what history_csv() has written. Throws FileError.
std::vector<HistoryPoint> read_history(const std::filesystem::path& file);

}  // namespace taut
