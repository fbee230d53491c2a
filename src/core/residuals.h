#pragma once

#include <string>
#include <vector>

#include "core/problem.h"
#include "core/result.h"

namespace taut {

/// What counts as solved, relative to the scales in Residuals.
struct Tolerances {
  double stationarity = 1e-6;     ///< of the largest single nodal force
  double feasibility = 1e-6;      ///< of each constraint's violation_scale()
  double complementarity = 1e-6;  ///< see Residuals::complementarity
  void validate() const;
};

/// How far one constraint is violated, in its own units.
struct Violation {
  std::string constraint;
  double max = 0;
  std::string where;  ///< name of the worst element, empty where nothing is violated
  Index element = -1;
};

/// How far a result is from optimal, computed from the problem and the result alone (the judge).
struct Residuals {
  double stationarity = 0;           ///< max nodal |grad f + sum w J^T lambda| / force_scale, free variables only
  double stationarity_unscaled = 0;  ///< the same in newtons
  double force_scale = 0;            ///< largest single nodal force of any term, pin reactions included, or
                                     ///< Problem::least_force_scale if that is larger, N
  double feasibility = 0;            ///< max over constraints of violation / violation_scale
  double feasibility_unscaled = 0;   ///< max violation in the constraint's own units
  double complementarity = 0;  ///< max_e |P(p + lambda/s) - p|, p = P(c), s the constraint's largest |lambda|: 0 iff
                               ///< lambda is in the normal cone at p
  double complementarity_unscaled = 0;  ///< the same times s
  std::string worst_node;               ///< index of the node with the largest stationarity residual
  std::vector<Violation> violations;    ///< one per constraint, one per system of equalities, and "pins" where
                                        ///< variables are fixed
  bool finite = true;

  bool within(const Tolerances& tolerances) const;
  /// The largest of the three in units of its tolerance, infinite where not finite.
  double over(const Tolerances& tolerances) const;
};

/// Judges any number of multipliers at one point, where the forces of the energies are computed once. Both arguments
/// are borrowed.
class Judge {
 public:
  /// Throws std::invalid_argument where x does not fit the problem.
  Judge(const Problem& problem, const Vector& x);
  /// One vector per constraint, then one per set of equalities; throws std::invalid_argument where sizes do not fit.
  Residuals operator()(const std::vector<Vector>& multipliers) const;

 private:
  const Problem& problem_;
  const Vector& x_;
  Vector energies_force_;
  double force_scale_ = 0;
  bool finite_ = true;
};

/// Throws std::invalid_argument where the result's sizes do not fit the problem.
Residuals residuals(const Problem& problem, const Result& result);

}  // namespace taut
