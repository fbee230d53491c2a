#pragma once

#include <map>
#include <optional>

namespace taut {

/// Distances between the answers of neighbouring levels of one refinement, level 0 the finest and each level half as
/// fine as the one before, and the error that they let expect.
///
/// Differences that shrink by a factor q from level to level, as Richardson's extrapolation has them, leave of the
/// difference d between the levels l and l - 1 an error d (1 + q + ... + q^(l-1)) of level l against level 0.
class Convergence {
 public:
  /// Taken where fewer than two differences are known: first order.
  static constexpr double usual_ratio = 0.5;
  /// What a measured ratio is cut off at: second order, and hardly any convergence.
  static constexpr double smallest_ratio = 0.25, largest_ratio = 0.9;

  /// Of the levels `level` and `level - 1`; infinite where one of them was not solved.
  void add(int level, double difference) { differences_[level] = difference; }
  bool knows(int level) const { return differences_.contains(level); }
  /// Throws std::out_of_range where it is not known.
  double difference(int level) const { return differences_.at(level); }
  /// q from the two finest neighbouring differences.
  double ratio() const { return measured_ratio().value_or(usual_ratio); }
  /// Expected error of a level against level 0: from its own difference, else the largest that coarser ones predict.
  /// Infinite where nothing is known, 0 for level 0.
  double error(int level) const { return error(level, ratio()); }
  /// The same where q is not measured and as small as it may be.
  double least_error(int level) const { return error(level, measured_ratio().value_or(smallest_ratio)); }

 private:
  double error(int level, double q) const;
  std::optional<double> measured_ratio() const;

  std::map<int, double> differences_;
};

}  // namespace taut
