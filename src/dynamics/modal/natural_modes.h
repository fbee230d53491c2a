#pragma once

#include <vector>

#include "dynamics/model.h"

namespace taut {

/// A natural vibration of a model about a state.
struct NaturalMode {
  double frequency;  ///< Hz; of an unstable state minus the rate of growth over 2 pi
  Vector shape;      ///< one entry per variable, zero at pins; kinetic energy 1/2 J at velocities of this size, kg^-1/2
  double residual;   ///< EigenPair::residual
};

/// The `count` lowest natural modes about the state x: those of the exact Hessian of `energies` (elastic ones and
/// loads) and the masses of the model, pins held. Stresses and follower loads of the state count. Constraints do not;
/// damping does not. Throws as EigenSolver does.
std::vector<NaturalMode> natural_modes(const Model& model, const std::vector<const Energy*>& energies, const Vector& x,
                                       int count, int threads);

}  // namespace taut
