#pragma once

#include <nlohmann/json_fwd.hpp>

#include "study/lean_ladder.h"

namespace taut {

/// Adds what replaces parts of a completed problem by simpler ones, or leaves out what costs time: thick shells as
/// sheets, merged layers, coarser covers or none, no bending, no strain limits, modes, another integrator. Applied in
/// the order of the ladder; what an earlier one has made impossible changes nothing.
void add_simpler_models(const nlohmann::json& document, LeanLadder& ladder);

/// Adds what else can be removed: loads, gravity, obstacles, damping, foundations and imperfections of covers.
void add_removals(const nlohmann::json& document, LeanLadder& ladder);

}  // namespace taut
