#pragma once

#include "dynamics/model.h"
#include "dynamics/stepper.h"

namespace taut {

/// True where something of the model carries tension in a surface: a membrane, a thick shell, or a strain limit.
bool has_tension(const Model& model);

/// The largest principal tension of any triangle at a state, N/m: of cloth the second Piola-Kirchhoff tension of its
/// membrane plus that of its strain limits' multipliers, of thick shells the larger eigenvalue of the resultants N.
double peak_tension(const Model& model, const State& state);

}  // namespace taut
