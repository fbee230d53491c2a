#pragma once

#include "core/convex_set.h"

namespace taut {

/// lower <= z_i <= upper in each of `dimension` coordinates; either bound may be infinite. [0, inf) is the orthant of
/// an obstacle's gap.
class Box final : public ConvexSet {
 public:
  Box(int dimension, double lower, double upper);
  int dimension() const override { return dimension_; }
  void project(Index element, const double* z, double* nearest, double* derivative) const override;
  bool contains_ball(Index element, const double* z, double radius) const override;
  void project_smoothed(Index element, const double* z, double epsilon, double* nearest, double* inverse,
                        double* rate) const override;
  int smooth_rows() const override { return dimension_; }
  void smooth_bounds(double* lower, double* upper) const override;
  void smooth_values(Index element, const double* z, double* g, double* jacobian) const override;
  void smooth_hessian(Index element, const double* z, const double* weights, double* hessian) const override;

 private:
  int dimension_;
  double lower_, upper_;
};

/// Symmetric 2x2 matrices with eigenvalues in [lower, upper], in the coordinates (a, sqrt2 b, c) of [a b; b c], in
/// which the Euclidean norm is Frobenius'. The projection clamps the eigenvalues; its derivative is the closed form of
/// a spectral function (divided differences, finite at coincident eigenvalues).
class SpectralBox final : public ConvexSet {
 public:
  SpectralBox(double lower, double upper);
  int dimension() const override { return 3; }
  void project(Index element, const double* z, double* nearest, double* derivative) const override;
  bool contains_ball(Index element, const double* z, double radius) const override;
  void project_smoothed(Index element, const double* z, double epsilon, double* nearest, double* inverse,
                        double* rate) const override;
  void project_smoothed_four(Index quad, const Pack* z, double epsilon, Pack* nearest, Pack* inverse,
                             Pack* rate) const override;
  /// Each finite limit gives tr A >= 0 and det A >= 0, with A = (upper I - z)/s or (z - lower I)/s and s the larger of
  /// the finite |limits|: rows of order one. Equal limits give the three equations z = lower I instead. Where both
  /// eigenvalues are at the same limit, the gradient of det A vanishes and no constraint qualification holds: only
  /// multiples of I are multipliers there, and near there the multiplier of det A grows like 1/(the smaller gap).
  int smooth_rows() const override;
  void smooth_bounds(double* lower, double* upper) const override;
  void smooth_values(Index element, const double* z, double* g, double* jacobian) const override;
  void smooth_hessian(Index element, const double* z, const double* weights, double* hessian) const override;

 private:
  template <class Real>
  void project_smoothed(const Real* z, double epsilon, Real* nearest, Real* inverse, Real* rate) const;

  double lower_, upper_;
  double smooth_scale_;  ///< s of the smooth rows
};

}  // namespace taut
