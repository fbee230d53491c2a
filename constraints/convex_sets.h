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
  void project_smoothed(Index element, const double* z, double epsilon, double* nearest, double* inverse,
                        double* rate) const override;

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
  void project_smoothed(Index element, const double* z, double epsilon, double* nearest, double* inverse,
                        double* rate) const override;

 private:
  double lower_, upper_;
};

}  // namespace taut
