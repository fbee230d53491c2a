#pragma once

#include <optional>
#include <vector>

#include "core/problem.h"
#include "core/result.h"

namespace taut {

/// How many independent directions of negative curvature the augmented Lagrangian has at a result, among those that
/// keep pins and linear equalities: 0 at a minimum, more at a saddle, as where a compressed sheet stays flat. Each
/// constraint counts with its multipliers and its penalty (missing ones: 1). From the inertia of [H A^T; A -1/mu] with
/// the exact H; nothing where that is singular.
std::optional<Index> negative_curvatures(const Problem& problem, const Result& result,
                                         const std::vector<double>& penalties);

}  // namespace taut
