#pragma once

#include "dynamics/stepper.h"
#include "problems/nl_writer.h"
#include "problems/scene.h"

namespace taut {

/// The step that `stepper` is about to take as a model, a static one with its whole load. Throws InputError where
/// step_as_nl() does.
NlFile export_step(const Scene& scene, const Model& model, Stepper& stepper);

}  // namespace taut
