#pragma once

#include <string>
#include <vector>

#include "core/solver.h"
#include "problems/nl_writer.h"

namespace taut {

/// A time step as a model that other people's solvers read: the same variables in the same order, pinned ones with
/// equal bounds; the start and, in its own rows, the multipliers of `warm`.
///
/// Written are inertia, loads that do not depend on the positions, foundations, stiffness damping, St. Venant-Kirchhoff
/// membranes, hinges; strain limits in matrix form as SpectralBox's smooth rows, half spaces, spheres and linear
/// equalities. Throws InputError, which begins with `source`, for anything else, by its name.
NlFile step_as_nl(const Problem& problem, const WarmStart& warm, std::vector<std::string> variable_names,
                  const std::string& source);

}  // namespace taut
