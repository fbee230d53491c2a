#pragma once

#include <array>

#include "core/types.h"

namespace taut {

/// A six-node prism: bottom and top node of each of the three mid-surface vertices, in turn (MLTS (22)).
using Prism = std::array<int, 6>;

/// Six surface points as mid-surface points X_j = (y_2j-1 + y_2j)/2 and half-thickness directors N_j = (y_2j -
/// y_2j-1)/2, one per column (MLTS (22)-(23)), in m.
struct PrismShape {
  Matrix3 mid, director;

  /// `points`: bottom and top of each vertex, in turn.
  explicit PrismShape(const std::array<Vector3, 6>& points);
};

/// det(dX/dq) of the prism map (MLTS (1)-(3)) as sum_k L_k (G_k + gamma H_k) + gamma^2 I, with L_k the barycentric
/// coordinates, in m^3 (ERRATA of MLTS (12): G_k = a . N_k, H_k = b . N_k, I = det(N1, N2, N3), a = X12 x X13,
/// b = X12 x N13 + N12 x X13).
struct PrismJacobian {
  Vector3 g, h;
  double i;

  explicit PrismJacobian(const PrismShape& shape);

  /// m^3: (G_1 + G_2 + G_3 + I)/3, negative where the prism is inside out.
  double volume() const { return (g.sum() + i) / 3; }
  /// The smallest value of G_k + gamma H_k + gamma^2 I on [-1, 1] over k, and the k where it is. The map has a positive
  /// determinant everywhere exactly where this value is positive, because the determinant is linear in L.
  double smallest(int* corner = nullptr) const;
};

}  // namespace taut
