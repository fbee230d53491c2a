#pragma once

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "solvers/augmented_lagrangian.h"
#include "solvers/eliminated_slack.h"
#include "solvers/equality_system.h"

namespace taut {

/// What is kept from solve to solve of the same topology.
struct AugmentedLagrangian::Workspace {
  std::uint64_t topology = 0;
  std::deque<EliminatedSlack> slacks;
  EqualityRows equalities;
  Assembly assembly;
  std::unique_ptr<Cholesky> cholesky;  // null with equalities or the null space
  std::unique_ptr<NewtonSystem> system;

  Workspace(const Problem& problem, const AugmentedLagrangianOptions& options);
};

/// One call of solve(): the loop of multiplier updates, ahead of it a try along the central path, and where violations
/// do not fall the search for the closest compromise.
struct AugmentedLagrangian::Run {
  const AugmentedLagrangianOptions& options;
  const Problem& problem;
  const Budget& budget;
  const std::function<void(const Iterate&)>& observer;
  Workspace& work;
  Newton newton;
  Result result;     // what is being improved
  Residuals judged;  // of `result`
  std::vector<double> start_penalty;
  std::vector<double> last_violation;
  Vector scratch;
  Index left_out = 0;   // elements of constraints
  Counts before_again;  // where the solve began again with them

  Run(const AugmentedLagrangianOptions& o, const Problem& p, const Budget& b,
      const std::function<void(const Iterate&)>& f, Workspace& w)
      : options(o),
        problem(p),
        budget(b),
        observer(f),
        work(w),
        newton(w.assembly, *w.system, w.equalities, p.fixed_variables, p.node_size, o.newton) {}

  void solve(const WarmStart& warm);
  void start(const WarmStart& warm);
  void leave_out(const WarmStart& warm);
  bool left_out_violated() const;
  bool constrained() const;
  long linear_solves() const { return result.counts.linear_solves - before_again.linear_solves; }
  void show(const Vector& x, const Vector& equal) const;
  Status inner(NewtonState& state);
  bool diverges(const Vector& x) const;
  void update(const NewtonState& state);
  bool update_penalties();
  bool penalise(double growth, double tolerance, NewtonState& state);
  bool closest_compromise(NewtonState& state);
  bool central_path();
  bool newton_finish();
  bool newton_step();
  void loop();
};

}  // namespace taut
