#include "study/convergence.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

std::optional<double> Convergence::measured_ratio() const {
  for (auto fine = differences_.begin(); fine != differences_.end(); ++fine) {
    const auto coarse = differences_.find(fine->first + 1);
    if (coarse == differences_.end() || !(coarse->second > 0) || !std::isfinite(coarse->second)) continue;
    return std::clamp(fine->second / coarse->second, smallest_ratio, largest_ratio);
  }
  return {};
}

double Convergence::error(int level, double q) const {
  if (level == 0) return 0;
  const double sum = (1 - std::pow(q, level)) / (1 - q);
  if (const auto own = differences_.find(level); own != differences_.end()) return own->second * sum;
  double largest = -1;
  for (auto coarse = differences_.upper_bound(level); coarse != differences_.end(); ++coarse)
    largest = std::max(largest, coarse->second * std::pow(q, coarse->first - level));
  return largest < 0 ? std::numeric_limits<double>::infinity() : largest * sum;
}

}  // namespace taut
