#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace taut {

/// A selection that fits no vertex of its mesh; what() is one line that says what was selected from what.
class SelectionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Every function returns vertex indices, ascending and without repetition, at least one. `label` names the mesh in
// messages. All throw SelectionError where nothing is selected or the mesh does not have what is asked for, and
// std::invalid_argument where an argument makes no sense for any mesh. Box and sphere include their border, with a
// slack of 1e-9 times the diagonal of the mesh's bounding box. Corners and edges of grids go by index, not position, so
// that they survive a transformation.

/// These very vertices; every index must be in range.
std::vector<int> select_indices(const TriangleMesh& mesh, std::span<const int> indices, const std::string& label);

/// The corner of a grid called "x0y0", "x1y0", "x0y1" or "x1y1"; x0 is where i = 0, x1 where i = cells_x.
std::vector<int> select_corner(const TriangleMesh& mesh, const std::string& name, const std::string& label);

/// The edge of a grid called "x0", "x1", "y0" or "y1", its corners included; x0 is where i = 0.
std::vector<int> select_edge(const TriangleMesh& mesh, const std::string& name, const std::string& label);

/// Vertices in the axis-aligned box from `low` to `high`, m.
std::vector<int> select_box(const TriangleMesh& mesh, const Vector3& low, const Vector3& high,
                            const std::string& label);

/// Vertices at most `radius` from `center`, m.
std::vector<int> select_sphere(const TriangleMesh& mesh, const Vector3& center, double radius,
                               const std::string& label);

/// The one vertex nearest to `point`; of several at the same distance the one with the lowest index.
std::vector<int> select_nearest(const TriangleMesh& mesh, const Vector3& point, const std::string& label);

/// Vertices on edges with a single triangle.
std::vector<int> select_boundary(const TriangleMesh& mesh, const std::string& label);

/// Vertices of a group that the mesh file names.
std::vector<int> select_group(const TriangleMesh& mesh, const std::string& name, const std::string& label);

/// All vertices.
std::vector<int> select_all(const TriangleMesh& mesh, const std::string& label);

}  // namespace taut
