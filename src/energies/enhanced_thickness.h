#pragma once

namespace taut {

/// No column has more points through the thickness.
inline constexpr int most_in_thickness = 4;

/// A column of points through a neo-Hookean shell where C33 grows by 2 c alpha. Its energy is, up to a constant, the
/// sum of w (mu c alpha + lambda/4 x - (lambda/4 + mu/2) ln x) with x = det C linear in alpha: convex, and infinite at
/// both ends of the interval where all x are positive.
struct EnhancedColumn {
  int count = 0;                          ///< points
  double weight[most_in_thickness];       ///< w
  double growth[most_in_thickness];       ///< c
  double determinant[most_in_thickness];  ///< x at alpha = 0
  double slope[most_in_thickness];        ///< dx/dalpha

  /// The alpha with the lowest energy, to round-off; NaN where no alpha makes all x positive.
  double minimiser(double lambda, double mu) const;
};

}  // namespace taut
