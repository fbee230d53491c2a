#pragma once

#include <optional>
#include <string>

#include "dynamics/model.h"
#include "problems/scene.h"

namespace taut::benchmarks {

/// Bounds on the singular values; without both there is no strain limit at all.
struct Limit {
  std::optional<double> min, max;
};

/// The catalogue's hanging cloth (scene H) with cells x cells squares and another strain limit.
Scene scene_h(int cells, const Limit& limit, const std::string& membrane_law = "stvk");

/// The model's start with every vertex moved by up to `fraction` of the cell size in each direction, the same on every
/// machine: flat and unstrained elements would take short cuts.
Vector crumpled(const Model& model, int cells, double fraction = 0.1);

}  // namespace taut::benchmarks
