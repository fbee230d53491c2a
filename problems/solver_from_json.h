#pragma once

#include <nlohmann/json_fwd.hpp>

#include "problems/scene.h"

namespace taut {

/// The section `solver` of a document that complete() has passed.
scene::Solver solver_from_json(const nlohmann::json& section);

}  // namespace taut
