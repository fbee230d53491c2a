#include "study/richardson.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace taut {

std::optional<Richardson> richardson(const Vector& coarse, const Vector& middle, const Vector& fine, double ratio,
                                     const DistanceOf& distance) {
  if (!(ratio > 1)) throw std::invalid_argument("richardson: expected a ratio above 1, got " + std::to_string(ratio));
  constexpr double lowest_order = 0.5, highest_order = 8;
  Richardson result;
  result.order = std::log(distance(coarse, middle) / distance(middle, fine)) / std::log(ratio);
  if (!(result.order >= lowest_order && result.order <= highest_order)) return {};
  result.limit = fine + (fine - middle) / (std::pow(ratio, result.order) - 1);
  result.error = distance(fine, result.limit);
  return result;
}

std::optional<double> observed_order(const std::vector<double>& sizes, const std::vector<double>& errors) {
  double count = 0, x_sum = 0, y_sum = 0, xx_sum = 0, xy_sum = 0;
  for (std::size_t k = 0; k < sizes.size() && k < errors.size(); ++k) {
    if (!(sizes[k] > 0 && errors[k] > 0) || !std::isfinite(sizes[k]) || !std::isfinite(errors[k])) continue;
    const double x = std::log(sizes[k]), y = std::log(errors[k]);
    ++count;
    x_sum += x, y_sum += y, xx_sum += x * x, xy_sum += x * y;
  }
  const double spread = count * xx_sum - x_sum * x_sum;
  if (count < 2 || !(spread > 1e-12 * count * xx_sum)) return {};
  return (count * xy_sum - x_sum * y_sum) / spread;
}

}  // namespace taut
