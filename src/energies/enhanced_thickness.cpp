#include "energies/enhanced_thickness.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

double EnhancedColumn::minimiser(double lambda, double mu) const {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (int g = 0; g < count; ++g) {
    if (slope[g] > 0) low = std::max(low, -determinant[g] / slope[g]);
    if (slope[g] < 0) high = std::min(high, -determinant[g] / slope[g]);
    if (slope[g] == 0 && !(determinant[g] > 0)) return nan;
  }
  if (!(low < high) || !std::isfinite(low) || !std::isfinite(high)) return nan;
  const double width = std::min(high - low, 1.0);
  double alpha = low < 0 && high > 0 ? 0 : 0.5 * (low + high);
  for (int iteration = 0; iteration < 100; ++iteration) {
    double first = 0, second = 0;
    for (int g = 0; g < count; ++g) {
      const double ratio = slope[g] / (determinant[g] + alpha * slope[g]);
      first += weight[g] * (mu * growth[g] + 0.25 * lambda * slope[g] - (0.25 * lambda + 0.5 * mu) * ratio);
      second += weight[g] * (0.25 * lambda + 0.5 * mu) * ratio * ratio;
    }
    const double step = -first / second;
    // Quadratic convergence: after a step this small the rest is round-off.
    if (std::abs(step) <= 1e-9 * width) return alpha + step;
    (first > 0 ? high : low) = alpha;
    alpha = alpha + step > low && alpha + step < high ? alpha + step : 0.5 * (low + high);
  }
  return alpha;
}

}  // namespace taut
