#pragma once

#include <vector>

#include "core/types.h"

namespace taut {

/// A point of the reference triangle in barycentric coordinates; weights sum to 1/2.
struct TrianglePoint {
  Vector3 l;
  double weight;
};
/// 1, 3 or 6 points inside, exact for degree 1, 2 or 4 (Dunavant 1985). Throws std::invalid_argument for other numbers.
const std::vector<TrianglePoint>& triangle_rule(int points);

/// A point of [-1, 1]; weights sum to 2.
struct LinePoint {
  double gamma, weight;
};
/// Gauss's rule with 1 to 4 points. Throws std::invalid_argument for other numbers.
const std::vector<LinePoint>& gauss_rule(int points);

}  // namespace taut
