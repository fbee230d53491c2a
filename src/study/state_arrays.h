#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/result.h"
#include "dynamics/model.h"
#include "dynamics/stepper.h"

namespace taut {

using NamedArrays = std::map<std::string, std::vector<double>>;

/// A state as the arrays of a checkpoint (files/checkpoint.h); its step is kept beside them.
NamedArrays state_arrays(const State& state);
/// What state_arrays() has made. Throws std::out_of_range where an array is missing.
State state_from(int step, const NamedArrays& arrays);

/// The positions of the vertices and the multipliers of a result as the arrays "positions", "multipliers 0", ...
NamedArrays solution_arrays(const Result& result, const Model& model);

/// An array of a checkpoint as a vector. Throws std::out_of_range where it is missing.
Vector vector_of(const NamedArrays& arrays, const std::string& name);

}  // namespace taut
