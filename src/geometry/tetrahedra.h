#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace taut {

using Tetrahedron = std::array<int, 4>;

/// A volume of tetrahedra.
struct TetrahedronMesh {
  std::vector<Vector3> vertices;   ///< m
  std::vector<Tetrahedron> cells;  ///< vertex indices, of positive volume
};

/// Reads the four-node tetrahedra of a Gmsh file (.msh, version 2.2, ASCII); other elements are passed over, vertices
/// that no tetrahedron has are left out. Throws MeshError, which names the file, for anything else, for a cell without
/// volume or a vertex that is not finite. Cells that are inside out are turned.
TetrahedronMesh read_tetrahedra(const std::filesystem::path& file);

/// The faces that belong to one cell only, counter-clockwise seen from outside.
std::vector<Triangle> boundary_triangles(const std::vector<Tetrahedron>& cells);

/// A box of cells_x x cells_y x cells_z cubes in six tetrahedra each, between the origin and `size` (m).
TetrahedronMesh make_box(const Vector3& size, int cells_x, int cells_y, int cells_z);

}  // namespace taut
