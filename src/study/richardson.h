#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/types.h"

namespace taut {

/// How far two results are apart, in the unit of an error.
using DistanceOf = std::function<double(const Vector&, const Vector&)>;

/// What three results, each finer than the one before by the same ratio, say of the limit [Richardson 1911].
struct Richardson {
  double order = 0;  ///< log of the ratio of their differences over log of the refinement
  Vector limit;      ///< extrapolated with that order
  double error = 0;  ///< distance of the finest from the limit
};

/// Nothing where the differences do not shrink like a power of the refinement: where the order is below 1/2 or beyond
/// 8, or a difference is zero or not finite. Throws std::invalid_argument for a ratio of at most 1.
std::optional<Richardson> richardson(const Vector& coarse, const Vector& middle, const Vector& fine, double ratio,
                                     const DistanceOf& distance);

/// The slope of log(error) over log(size), by least squares; nothing for fewer than two points with different positive
/// sizes and positive errors.
std::optional<double> observed_order(const std::vector<double>& sizes, const std::vector<double>& errors);

}  // namespace taut
