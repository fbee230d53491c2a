#pragma once

#include "core/types.h"

namespace taut {

enum class CgEnd { converged, negative_curvature, iteration_limit };

/// Preconditioned conjugate gradients for A x = b from x = 0 [Hestenes and Stiefel 1952]. `apply(v, out)` and
/// `precondition(r, out)` set `out` to A v and B^-1 r, B positive definite. It ends where `done(residual)`, or at a
/// direction of no positive curvature (or none that is a number), x being what it had before [Steihaug 1983]. Adds to
/// `iterations`, of which there are at most `most`.
template <class Apply, class Precondition, class Done>
CgEnd conjugate_gradients(const Vector& b, const Apply& apply, const Precondition& precondition, const Done& done,
                          Index most, Vector& x, Index& iterations) {
  x.setZero(b.size());
  Vector residual = b, preconditioned, direction, product;
  double last = 0;
  for (Index iteration = 0; !done(residual); ++iteration) {
    if (iteration == most) return CgEnd::iteration_limit;
    ++iterations;
    precondition(residual, preconditioned);
    const double energy = residual.dot(preconditioned);
    if (iteration == 0) {
      direction = preconditioned;
    } else {
      direction = preconditioned + (energy / last) * direction;
    }
    last = energy;
    apply(direction, product);
    const double curvature = direction.dot(product);
    if (!(curvature > 0)) return CgEnd::negative_curvature;
    x += (energy / curvature) * direction;
    residual -= (energy / curvature) * product;
  }
  return CgEnd::converged;
}

}  // namespace taut
