#pragma once

#include "core/types.h"

namespace taut {

/// F = d1 u1 v1^T + d2 u2 v2^T with d1 >= d2 >= 0; n = u1 x u2. Left vectors of a vanishing singular value are any
/// orthonormal completion.
struct Svd32 {
  double d1, d2;
  Vector3 u1, u2, n;
  Vector2 v1, v2;
};

/// Closed form. d1 and d2 are accurate relative to d1 (d2 through the area |f1 x f2| = d1 d2, so no digits are lost to
/// squaring).
Svd32 svd(const Matrix32& f);

/// Only the singular values {d1, d2}.
Vector2 singular_values(const Matrix32& f);

}  // namespace taut
