#pragma once

#include <memory>
#include <vector>

#include "dynamics/model.h"
#include "problems/body_shape.h"
#include "problems/scene.h"

namespace taut {

/// Adds the masses of a thick shell and its surfaces to a model, and returns its elastic energies, one a layer. Throws
/// InputError.
std::vector<std::unique_ptr<Energy>> add_shell(const Scene& scene, const scene::Body& body, const BodyShape& shape,
                                               Model& model);

/// Adds the scene's pins, strain limits and obstacles to a model whose positions are there. Throws InputError.
void add_constraints(const Scene& scene, const std::vector<BodyShape>& shapes, Model& model);

/// Adds gravity and the loads to a model whose inertia and pins are there. Throws InputError.
void add_loads(const Scene& scene, const std::vector<BodyShape>& shapes, Model& model);

}  // namespace taut
