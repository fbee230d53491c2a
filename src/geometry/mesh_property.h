#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace taut {

/// A number at each vertex of a PLY file, text or binary, in the file's order: its vertex property `name`.
///
/// Throws MeshError with one line, "cloth.ply: what is wrong": a file of another kind, one that read_mesh() would
/// refuse for its header, a property that is missing or a list, an end before the last vertex.
std::vector<double> read_vertex_property(const std::filesystem::path& path, const std::string& name);

}  // namespace taut
