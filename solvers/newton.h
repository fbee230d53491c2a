#pragma once

#include <functional>

#include "core/assembly.h"
#include "core/solver.h"
#include "linalg/cholesky.h"

namespace taut {

struct NewtonOptions {
  int max_iterations = 200;           ///< linear solves in one call
  int max_halvings = 40;              ///< of the step in one line search
  double sufficient_decrease = 1e-4;  ///< Armijo's constant
  double guard = 0.9;                 ///< fraction of the largest step that guarded elements allow
  void validate() const;
};

/// Where a minimisation stands.
struct NewtonState {
  Vector x;
  Vector gradient;  ///< zero at fixed variables
  double value = 0;
  double nodal_norm = 0;  ///< largest Euclidean norm of the gradient over nodes, N
};

/// Semismooth Newton with an Armijo line search on a sum of energies. The exact Hessian is tried first; where it is not
/// positive definite or its step fails, the positive semidefinite one serves for some iterations. A shift is added
/// where even that is singular (slack static membranes).
class Newton {
 public:
  /// The assembly has been put in the order that `cholesky` has analysed; both are borrowed.
  Newton(Assembly& assembly, Cholesky& cholesky, int node_size, NewtonOptions options);

  /// Minimises from state.x (fixed variables stay) until done(state); returns solved, iteration_limit, stalled,
  /// not_finite, time_limit or interrupted. The state that `done` last saw is in `state`.
  Status minimise(NewtonState& state, const std::function<bool(const NewtonState&)>& done, const Budget& budget,
                  Counts& counts, Timings& timings);

 private:
  void evaluate(NewtonState& state, Counts& counts, Timings& timings);
  bool direction(const NewtonState& state, Counts& counts, Timings& timings);
  bool line_search(NewtonState& state, Counts& counts, Timings& timings);

  Assembly& assembly_;
  Cholesky& cholesky_;
  int node_size_;
  NewtonOptions options_;
  Vector step_, right_hand_side_, solution_;
  NewtonState trial_;
  Curvature curvature_ = Curvature::positive_semidefinite;
  int wait_ = 0;  // iterations before the exact Hessian is tried again
  int patience_ = 1;
};

/// The largest Euclidean norm over nodes of `node_size` consecutive entries.
double nodal_max_norm(const Vector& force, int node_size);

}  // namespace taut
