#pragma once

#include <string>
#include <vector>

#include "dynamics/model.h"

namespace taut {

/// How one constraint, or one kind of bad face, fares at given positions. Values are in the constraint's own units
/// (singular values, metres) and 0 where an element is inside.
struct Verdict {
  std::string constraint;
  double max = 0;
  double percentile99 = 0;  ///< 99 % of the elements have at most this
  double allowed = 0;       ///< tolerance times what a violation of "one" means
  Index elements = 0, violated = 0;
  std::string where;  ///< the worst element, empty where nothing is violated

  double share() const { return elements > 0 ? static_cast<double>(violated) / static_cast<double>(elements) : 0; }
  bool within() const { return violated == 0; }
};

/// Judges positions by the constraints of a model as they are at one time.
class PositionJudge {
 public:
  /// The model is borrowed; its obstacles are moved. `tolerance` is relative to Constraint::violation_scale(), for pins
  /// to the diagonal of the scene at its start.
  PositionJudge(Model& model, double tolerance);

  /// One verdict for each constraint, one for each coupling, then one for the pins where there are any. `time` in s
  /// (static: load fraction).
  std::vector<Verdict> constraints(const Vector& x, double time) const;

  /// Two verdicts on the faces themselves.
  ///
  /// "inverted faces", in degrees: the angle between the area vectors of a face and a neighbour across an edge, the
  /// second largest of those with neighbours that were within 90 degrees at the start; allowed is `largest_fold`. A
  /// vertex that crossed its opposite edge leaves a face at 180 degrees from two neighbours or three. In space nothing
  /// else tells such a face from one that is folded over along two edges; a fold along one edge counts for nothing.
  ///
  /// "degenerate faces": longest edge over height, infinite without area; allowed is 1e4.
  std::vector<Verdict> faces(const Vector& x, double largest_fold) const;

 private:
  Verdict pins(const Vector& x, double time) const;

  Model& model_;
  double tolerance_, size_;
  std::vector<std::vector<int>> neighbours_;  // of each triangle, across edges where the start has no fold
};

}  // namespace taut
