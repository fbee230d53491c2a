#pragma once

#include <vector>

#include "core/types.h"

namespace taut {

/// The share of instances that are solved within x: a step function that jumps to share[k] at x[k] and is 0 before.
struct Profile {
  std::vector<double> x;      ///< ascending
  std::vector<double> share;  ///< in [0, 1]

  /// The value at `at`.
  double operator()(double at) const;
};

/// Performance profiles [Dolan and More 2002]: of each solver the share of instances that it solves in at most x times
/// the cost of the best. `costs` has a row per instance and a column per solver, positive, infinity where it is not
/// solved; instances that nobody solves count as unsolved. Throws std::invalid_argument for other costs.
std::vector<Profile> performance_profiles(const Matrix& costs);

/// Data profiles [More and Wild 2009]: of each solver the share of instances that it solves at a cost of at most x.
/// `costs` as above, in a unit that makes instances of different size comparable.
std::vector<Profile> data_profiles(const Matrix& costs);

/// exp(mean(log(value + shift))) - shift, in which neither the smallest nor the largest values rule. Throws
/// std::invalid_argument for no values and where value + shift is not positive.
double shifted_geometric_mean(const std::vector<double>& values, double shift);

}  // namespace taut
