#include "study/pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

std::vector<std::size_t> pareto_front(const std::vector<WorkPrecision>& points) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (std::isfinite(points[k].cost) && std::isfinite(points[k].error)) order.push_back(k);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].cost != points[b].cost ? points[a].cost < points[b].cost : points[a].error < points[b].error;
  });
  std::vector<std::size_t> front;
  double smallest = std::numeric_limits<double>::infinity();
  for (const std::size_t k : order) {
    if (!(points[k].error < smallest)) continue;
    smallest = points[k].error;
    front.push_back(k);
  }
  return front;
}

}  // namespace taut
