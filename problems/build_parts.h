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

/// Adds mass and elasticity of a body to a model. Throws InputError.
void add_material(const Scene& scene, const scene::Body& body, const BodyShape& shape, Model& model);

/// Whether the scene is of a body that moves in its modes.
bool is_modal(const Scene& scene);

/// Turns a model that has only the mesh of a modal body into one of its modes, with loads and constraints. Throws
/// InputError.
void reduce_to_modes(const Scene& scene, const BodyShape& shape, Model& model);

/// The foundation of a cover that has one.
std::unique_ptr<Energy> foundation_of(const scene::Body& body, const BodyShape& shape);

/// Adds the couplings of covers to their shells to a model whose pins are there, and notes what a person should know:
/// far points, wrinkles that would be too long, pins that decide coupling equations alone. Throws MeshError.
void add_couplings(const Scene& scene, const std::vector<BodyShape>& shapes, Model& model);

/// Diagonal of the box around all nodes, m.
double scene_size(const Vector& positions);

/// Adds the scene's pins, strain limits and obstacles to a model whose positions are there. Throws InputError.
void add_constraints(const Scene& scene, const std::vector<BodyShape>& shapes, Model& model);

/// Adds gravity and the loads to a model whose inertia and pins are there. Throws InputError.
void add_loads(const Scene& scene, const std::vector<BodyShape>& shapes, Model& model);

}  // namespace taut
