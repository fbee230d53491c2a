#pragma once

#include <algorithm>
#include <cmath>

#include "core/pack.h"
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

/// The symmetric matrix [a b; b c] of doubles, or four of them.
template <class Real>
struct Symmetric2 {
  Real a, b, c;
};

/// The eigenvalues mean + radius and mean - radius of such a matrix, and the projector [cc cs; cs ss] onto the first
/// one's eigenvector (cosine c, sine s; 1 and 0 where the eigenvalues coincide). Small entries of it are accurate, too:
/// a matrix put together with a zero eigenvalue is as singular as doubles allow.
template <class Real>
struct Spectrum2 {
  Real mean, radius, cosine, cc, cs, ss;  ///< `cosine` of twice the angle

  explicit Spectrum2(const Symmetric2<Real>& m) {
    const Real half = 0.5 * (m.a - m.c);
    mean = 0.5 * (m.a + m.c);
    radius = square_root(half * half + m.b * m.b);
    const auto apart = radius > Real(0.0);
    const Real inverse = 1.0 / radius;
    cosine = select(apart, half * inverse, Real(1.0));
    cs = select(apart, 0.5 * m.b * inverse, Real(0.0));
    const Real large = 0.5 + 0.5 * absolute(cosine), small = cs * cs / large;
    const auto first = cosine >= Real(0.0);
    cc = select(first, large, small);
    ss = select(first, small, large);
  }
  Real high() const { return mean + radius; }
  Real low() const { return mean - radius; }
  /// The matrix with these eigenvalues instead, and the same eigenvectors.
  Symmetric2<Real> with_values(Real first, Real second) const {
    return {first * cc + second * ss, (first - second) * cs, first * ss + second * cc};
  }
};

/// The nearest positive semidefinite matrix to m: its eigenvalues below zero become zero.
template <class Real>
Symmetric2<Real> positive_part(const Symmetric2<Real>& m) {
  const Spectrum2<Real> spectrum(m);
  const Symmetric2<Real> part = spectrum.with_values(larger(spectrum.high(), Real(0.0)), Real(0.0));
  const auto is_one = spectrum.low() >= Real(0.0);
  return {select(is_one, m.a, part.a), select(is_one, m.b, part.b), select(is_one, m.c, part.c)};
}

/// The nearest positive semidefinite matrix to the symmetric `m`: its eigenvalues below zero become zero.
inline Matrix2 positive_part(const Matrix2& m) {
  const Eigen2 pair = eigen2(m(0, 0), m(0, 1), m(1, 1));
  if (pair.values[1] >= 0) return m;
  const double high = std::max(pair.values[0], 0.0);
  return high * pair.vectors.col(0) * pair.vectors.col(0).transpose();
}

}  // namespace taut
