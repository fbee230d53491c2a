#pragma once

#include <cstdint>
#include <istream>
#include <string>

namespace taut {

/// Reads a PLY header and throws MeshError, "cloth.ply:7: what is wrong", at anything that CGAL 5.5 would crash on,
/// misread or not explain: a property without an element or of an unknown type, vertices without x, y, z as float or
/// double, faces without a list vertex_indices (or vertex_index) of 32-bit integers, more items than the file has
/// bytes, a header without an end. Leaves `in` behind the header.
void require_readable_ply_header(std::istream& in, const std::string& file, std::uintmax_t file_size);

}  // namespace taut
