#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/types.h"

namespace taut {

using Triangle = std::array<int, 3>;

/// A triangle surface as read or built: nothing here is checked (see topology.h for that).
struct TriangleMesh {
  std::vector<Vector3> vertices;                   ///< m
  std::vector<Triangle> triangles;                 ///< vertex indices, counter-clockwise seen from outside
  std::vector<std::array<Vector2, 3>> corner_uv;   ///< one per triangle, or empty
  std::map<std::string, std::vector<int>> groups;  ///< vertex groups by name (OBJ `g`/`o`), ascending; may be empty
  /// For built-in grids: cells along x and y, 0 otherwise. Vertex (i, j) is j * (cells_x + 1) + i.
  int cells_x = 0, cells_y = 0;
};

}  // namespace taut
