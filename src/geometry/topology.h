#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/triangle_mesh.h"

namespace taut {

/// A mesh that cannot be used; what() is one line that names the mesh or file and the place in it.
class MeshError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An edge v0 -> v1 with the triangles beside it. `left` runs through it from v0 to v1, `right` from v1 to v0.
struct Edge {
  int v0, v1;
  int left, right;                    ///< triangles; right is -1 at a boundary
  int opposite_left, opposite_right;  ///< the third vertex of either triangle, -1 where there is none
};

/// Every edge once, in the order and direction in which the triangles first show it.
/// Throws MeshError at an edge with more than two triangles or with two that run through it the same way.
std::vector<Edge> edges(const TriangleMesh& mesh);

/// Vertices on edges with a single triangle, ascending. Throws as edges() does.
std::vector<int> boundary_vertices(const TriangleMesh& mesh);

/// True where every edge has two triangles and there is at least one. Throws as edges() does.
bool is_closed(const TriangleMesh& mesh);

/// Throws MeshError at the first thing that would make elements singular or neighbours ambiguous, as
/// "cloth.obj: face 17 (vertices 3, 4, 5): zero area". Faces and vertices count from 0; `label` names the mesh or its
/// file.
///
/// In this order: no faces; a vertex that is not finite; per face an index out of range, a repeated vertex, an area
/// that is not finite or at most 1e-12 times the longest edge squared; then a duplicate face; an edge with more than
/// two faces or with two that run through it the same way; a vertex that no face uses (it would have no mass). Vertices
/// where two fans touch are allowed.
void validate(const TriangleMesh& mesh, const std::string& label);

}  // namespace taut
