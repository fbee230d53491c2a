#pragma once

#include <filesystem>
#include <vector>

#include "core/types.h"
#include "files/file_error.h"
#include "geometry/triangle_mesh.h"

namespace taut {

/// Writes a Wavefront OBJ file atomically. `positions` holds x, y, z of each vertex in metres; they are written with as
/// many digits (at most 17) as give the same doubles back. Throws std::invalid_argument for sizes, indices and
/// coordinates that do not fit, FileError.
void write_obj(const std::filesystem::path& path, const Vector& positions, const std::vector<Triangle>& triangles);

}  // namespace taut
