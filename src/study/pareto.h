#pragma once

#include <cstddef>
#include <vector>

namespace taut {

/// What a point of a work-precision diagram costs, and how wrong it is.
struct WorkPrecision {
  double cost = 0, error = 0;
};

/// The points that no other beats in cost without being worse in error, or the reverse, by their places in ascending
/// cost. Points of which either is not finite are on no front; of equal points the first is.
std::vector<std::size_t> pareto_front(const std::vector<WorkPrecision>& points);

}  // namespace taut
