#pragma once

#include <memory>

#include "core/solver.h"
#include "dynamics/modal/modal_basis.h"
#include "dynamics/model.h"
#include "dynamics/stepper.h"
#include "problems/scene.h"

namespace taut {

/// Reads the meshes of a scene and assembles exactly the energies and constraints that it names, with obstacles where
/// they are at time 0. Throws InputError, "FILE: /constraints/NAME/select: ...", for what only the meshes can tell: a
/// mesh that cannot be used, an empty selection, two pins that move one coordinate differently.
std::unique_ptr<Model> build_model(const Scene& scene);

/// The modes of a scene of a modal body. Throws InputError where there is none.
ModalBasis build_modal_basis(const Scene& scene);

TimeOptions time_options(const Scene& scene);

/// The solver that the scene asks for; `threads` is for assembly and factorisation.
std::unique_ptr<Solver> build_solver(const Scene& scene, int threads);

}  // namespace taut
