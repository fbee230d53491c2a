#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "core/problem.h"
#include "core/residuals.h"
#include "core/result.h"

namespace taut {

/// What an earlier step knows. Empty vectors and a zero mean: nothing.
struct WarmStart {
  std::vector<Vector> multipliers;
  std::vector<double> penalties;
  double force_scale = 0;       ///< N, Residuals::force_scale at its end
  std::vector<double> changes;  ///< as in Result
};

/// When to give up early: a point in time, or a flag that a signal handler raises.
struct Budget {
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
  const std::atomic<bool>* stop = nullptr;

  bool interrupted() const { return stop && stop->load(std::memory_order_relaxed); }
  bool out_of_time() const { return std::chrono::steady_clock::now() >= deadline; }
};

/// Where a solver stands after an iteration. All of it is borrowed.
struct Iterate {
  const Vector& x;
  const std::vector<Vector>& multipliers;  ///< as in Result
  double penalty = 0;                      ///< the largest of any constraint; 0 where the solver has none
  const Counts& counts;                    ///< so far in this solve
};

/// Solves one Problem. A solver may keep patterns and symbolic factors between calls (Problem::topology), so `solve` is
/// not const; what it returns depends on its arguments only.
class Solver {
 public:
  virtual ~Solver() = default;
  virtual std::string name() const = 0;
  virtual Result solve(const Problem& problem, const WarmStart& warm, const Budget& budget) = 0;

  /// Called with the start and after every iteration. Empty, it costs nothing; it changes no result. Solvers that show
  /// no iterates never call it.
  std::function<void(const Iterate&)> observer;
};

}  // namespace taut
