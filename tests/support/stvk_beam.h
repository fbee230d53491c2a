#pragma once

#include "core/types.h"

namespace taut {

/// The plane beam that a strip of St. Venant-Kirchhoff material with nu = 0, width 1 and one layer of straight
/// directors is: the section turns by theta, its director has the stretch delta, and the mid-line's tangent has the
/// parts a across the director and b along it. With K = delta theta' a fibre at height z has
/// E11 = (a^2 + b^2 - 1 - 2 a K z + K^2 z^2)/2, 2 E13 = b delta and E33 = (delta^2 - 1)/2; slopes of delta are left
/// out. The equations are solved by shooting; nothing is shared with the prism's code.
struct StvkBeam {
  double young, thickness, shear_correction, length;

  /// The tip (forward, upward), m, under a moment at the tip, N m.
  Vector2 tip_under_moment(double moment) const;
  /// The tip under an upward force there that keeps its direction, N.
  Vector2 tip_under_force(double force) const;
};

}  // namespace taut
