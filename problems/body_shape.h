#pragma once

#include <array>
#include <string>
#include <vector>

#include "geometry/rest_shape.h"
#include "geometry/triangle_mesh.h"
#include "problems/scene.h"

namespace taut {

/// A body's mesh where it starts, and its shape without stress.
struct BodyShape {
  std::string name;
  int first_vertex = 0, first_triangle = 0;     ///< within the scene
  TriangleMesh mesh;                            ///< transformed; its indices count within the body
  std::vector<Vector3> rest_positions;          ///< m, one per vertex; empty for a rest shape from uv
  std::vector<std::array<Vector2, 3>> rest_uv;  ///< m, one triple per triangle; empty otherwise
  std::vector<RestTriangle> rest;               ///< scene vertices

  /// Length of the edge from a triangle's corner k to its next one, m.
  double rest_edge_length(int triangle, int k) const;
};

/// Reads or makes the mesh of scene.bodies[index], places it and finds its rest shape. `before` is the body built just
/// before, or null. Throws InputError for a mesh or a rest shape that cannot be used.
BodyShape make_body_shape(const Scene& scene, std::size_t index, const BodyShape* before);

/// The vertices selected, counted within the body, ascending. Throws InputError with `pointer` where there are none.
std::vector<int> selected_vertices(const Scene& scene, const BodyShape& shape, const scene::Selection& selection,
                                   const std::string& pointer);

}  // namespace taut
