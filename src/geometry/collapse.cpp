#include "geometry/collapse.h"

#include <cmath>
#include <limits>

#include "core/types.h"

namespace taut {

double step_before_collapse(const double* x, const double* dx) {
  constexpr double kept = 0.1;
  const Eigen::Map<const Matrix3> p(x), d(dx);
  const Vector3 a = p.col(1) - p.col(0), b = p.col(2) - p.col(0), da = d.col(1) - d.col(0), db = d.col(2) - d.col(0);
  const Vector3 normal = a.cross(b);
  const double square = normal.squaredNorm();
  if (!(square > 0)) return std::numeric_limits<double>::infinity();
  // Projected area over present area along the step: 1 + linear s + quadratic s^2; find the smallest s > 0 where it is
  // `kept`.
  double linear = (da.cross(b) + a.cross(db)).dot(normal), quadratic = da.cross(db).dot(normal);
  constexpr double constant = 1 - kept;
  if (2 * std::abs(linear) + 4 * std::abs(quadratic) < constant * square)
    return std::numeric_limits<double>::infinity();
  linear /= square;
  quadratic /= square;
  const double discriminant = linear * linear - 4 * quadratic * constant;
  if (discriminant < 0) return std::numeric_limits<double>::infinity();
  const double q = -0.5 * (linear + std::copysign(std::sqrt(discriminant), linear));
  double smallest = std::numeric_limits<double>::infinity();
  for (double root : {q / quadratic, constant / q}) {
    if (std::isfinite(root) && root > 0 && root < smallest) smallest = root;
  }
  return smallest;
}

}  // namespace taut
