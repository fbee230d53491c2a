#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/types.h"

namespace taut {

/// What a mesh file says before its polygons are cut into triangles; the readers have checked that all indices are in
/// range. Used by mesh_file*.cpp only.
struct PolygonSoup {
  std::vector<Vector3> points;
  std::vector<std::vector<int>> polygons;          ///< indices of points
  std::vector<std::vector<Vector2>> corner_uv;     ///< as polygons, or empty
  std::map<std::string, std::vector<int>> groups;  ///< points by name, ascending
  std::vector<int> lines;                          ///< the line of each polygon in a text file, or empty
};

/// Throws MeshError.
PolygonSoup read_obj(const std::filesystem::path& path);

/// Reads PLY, OFF or STL by the (lower-case) extension. Throws MeshError, in a build without CGAL always.
PolygonSoup read_through_cgal(const std::filesystem::path& path, const std::string& extension);

}  // namespace taut
