#pragma once

#include <algorithm>
#include <cmath>

#include "core/types.h"

namespace taut {

/// Eigenpairs of a symmetric 2x2 matrix: values[0] >= values[1], vectors orthonormal columns with determinant +1.
struct Eigen2 {
  double values[2];
  Matrix2 vectors;
};

/// Closed form for [a b; b c]; relative accuracy of the larger value in magnitude is about 1e-16, coincident values are
/// fine; entries have to be between 1e-150 and 1e150 in magnitude, or zero.
inline Eigen2 eigen2(double a, double b, double c) {
  const double mean = 0.5 * (a + c), half = 0.5 * (a - c), radius = std::sqrt(half * half + b * b);
  Eigen2 pair;
  pair.values[0] = mean + radius;
  pair.values[1] = mean - radius;
  // The first eigenvector is (radius + half, b) or (b, radius - half): the one without cancellation.
  double x = 1, y = 0;
  if (radius > 0) {
    if (half >= 0) {
      x = radius + half;
      y = b;
    } else {
      x = std::abs(b);
      y = std::copysign(radius - half, b);
    }
    const double inverse = 1 / std::sqrt(x * x + y * y);
    x *= inverse;
    y *= inverse;
  }
  pair.vectors << x, -y, y, x;
  return pair;
}

/// The nearest positive semidefinite matrix to the symmetric `m`: its eigenvalues below zero become zero.
inline Matrix2 positive_part(const Matrix2& m) {
  const Eigen2 pair = eigen2(m(0, 0), m(0, 1), m(1, 1));
  if (pair.values[1] >= 0) return m;
  const double high = std::max(pair.values[0], 0.0);
  return high * pair.vectors.col(0) * pair.vectors.col(0).transpose();
}

}  // namespace taut
