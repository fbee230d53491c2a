#pragma once

#include <string_view>
#include <vector>

#include "core/types.h"
#include "geometry/triangle_mesh.h"

namespace taut {

/// Throws std::invalid_argument, naming `caller`, where `positions` is not made of triples or a triangle names a vertex
/// that is not there.
void check_surface(std::string_view caller, const Vector& positions, const std::vector<Triangle>& triangles);

}  // namespace taut
