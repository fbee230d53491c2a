#pragma once

#include <random>

#include "core/types.h"

namespace taut {

/// Values between -1 and 1 from a fixed seed, so that a failing test fails again.
class RandomValues {
 public:
  explicit RandomValues(unsigned seed) : generator_(seed) {}

  double value() { return 2.0 * static_cast<double>(generator_()) / static_cast<double>(std::mt19937::max()) - 1.0; }
  double between(double low, double high) { return low + (high - low) * 0.5 * (value() + 1); }
  Vector vector(Index size) {
    Vector v(size);
    for (double& entry : v) entry = value();
    return v;
  }
  Matrix matrix(Index rows, Index columns) { return vector(rows * columns).reshaped(rows, columns); }
  /// A rotation by an angle between -3 and 3 about any axis.
  Matrix3 rotation() { return Eigen::AngleAxisd(3 * value(), vector(3).normalized()).toRotationMatrix(); }

 private:
  std::mt19937 generator_;
};

}  // namespace taut
