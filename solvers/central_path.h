#pragma once

#include <deque>
#include <functional>
#include <limits>

#include "core/assembly.h"
#include "core/solver.h"
#include "solvers/eliminated_slack.h"
#include "solvers/newton.h"

namespace taut {

struct CentralPathOptions {
  bool enabled = true;
  double penalty_fraction = 0.03;  ///< of the augmented Lagrangian's penalty: the scale mu in y = c + lambda/mu
  double reduction = 0.1;          ///< of epsilon mu aimed at in one step
  double centred = 20;             ///< mismatch over smoothing width below which a reduction is aimed at
  double tolerated_rise = 1.5;     ///< of the merit in one step: it is lower only once the path is near
  double smallest_width = 1e-11;   ///< final smoothing width, in the constraint's scale
  int exact_after = 20;            ///< linear solves with semidefinite matrices, which are slow to leave a saddle
  int max_iterations = 100;        ///< linear solves before the augmented Lagrangian takes over
  int max_halvings = 6;
  double longest_step = std::numeric_limits<double>::infinity();  ///< as in NewtonOptions
  void validate() const;
};

/// Follows the path of problems in which each eliminated slack carries a logarithmic barrier: min over s of L_A(x, s) -
/// tau sum log s. The slack is still eliminated in closed form (ConvexSet::project_smoothed), which makes the
/// conditions smooth; positions, multipliers and the barrier move in the same Newton step, along the path's tangent. It
/// needs few linear solves where it works; where it does not (both limits of one triangle at once) it says so.
///
/// `assembly` sums the problem's energies and the `slacks`; all are borrowed, and the slacks are left with their last
/// multipliers. Forces on the variables `fixed` do not count. Linear equalities and their multipliers, `equal`, are
/// part of every Newton step. `judge(x)` gives the worst of the residuals over their tolerances; it is asked once
/// smoothing and forces are small, and at most 1 ends the path with true. `observe(x)`, where it is not empty, sees the
/// start and every point after it.
bool follow_central_path(Assembly& assembly, NewtonSystem& system, const EqualityRows& equalities,
                         std::deque<EliminatedSlack>& slacks, const std::vector<int>& fixed, int node_size,
                         double force_scale, const Tolerances& tolerances, const CentralPathOptions& options,
                         int threads, Vector& x, Vector& equal, const std::function<double(const Vector&)>& judge,
                         const std::function<void(const Vector&)>& observe, const Budget& budget, Counts& counts,
                         Timings& timings);

}  // namespace taut
