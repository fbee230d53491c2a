#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "geometry/layered_mesh.h"
#include "geometry/prolongation.h"
#include "geometry/rest_shape.h"
#include "geometry/tetrahedra.h"
#include "geometry/triangle_mesh.h"
#include "problems/scene.h"

namespace taut {

/// A body's mesh where it starts, and its shape without stress. A thick shell has several nodes at each vertex of its
/// mesh, and two surfaces; cloth has a node a vertex and one surface.
struct BodyShape {
  std::string name;
  int first_node = 0, first_triangle = 0;       ///< within the scene
  TriangleMesh mesh;                            ///< transformed; its indices count within the body
  std::optional<LayeredMesh> layered;           ///< of thick shells, about or between the mesh; m
  std::vector<Vector3> rest_positions;          ///< m, one per vertex; empty for a rest shape from uv
  std::vector<std::array<Vector2, 3>> rest_uv;  ///< m, one triple per triangle; empty otherwise
  std::vector<RestTriangle> rest;  ///< on scene nodes: the mesh; of thick shells bottom (inside out), then top

  std::vector<Tetrahedron> tetrahedra;  ///< of solids, whose mesh has all their vertices and the boundary's triangles

  std::optional<Prolongation> prolongation;  ///< of covers, from the surface of their shell
  std::vector<std::vector<int>> carriers;    ///< of covers: scene nodes whose mean is each vertex of that surface
  std::vector<Triangle> carrying_triangles;  ///< of covers: those of that surface

  const Triangle& carrying_triangle(const Anchor& anchor) const {
    return carrying_triangles[static_cast<std::size_t>(anchor.triangle)];
  }
  int levels() const { return layered ? layered->layers + 1 : 1; }
  int nodes() const { return static_cast<int>(mesh.vertices.size()) * levels(); }
  /// The scene's node at a vertex; level 0 is the bottom.
  int node(int vertex, int level) const { return first_node + vertex * levels() + level; }
  /// The level of bottom, top or mid.
  int level(scene::Surface surface) const;
  /// The scene's nodes at a vertex on a surface; `both` counts those between.
  std::vector<int> nodes_at(int vertex, scene::Surface surface) const;
  /// Those whose mean position is that of the surface: two for `both`, and for `mid` inside a prism.
  std::vector<int> mean_nodes(int vertex, scene::Surface surface) const;
  /// Those of them that share a force on the vertex: bottom and top for `both`.
  std::vector<int> loaded_nodes(int vertex, scene::Surface surface) const;
  /// Length of the edge from a triangle's corner k to its next one, m.
  double rest_edge_length(int triangle, int k) const;
};

/// Reads or makes the mesh of scene.bodies[index], places it and finds its rest shape. `before` is the body built just
/// before, or null; of a cover it is the shell. Throws InputError for a mesh or a rest shape that cannot be used.
BodyShape make_body_shape(const Scene& scene, std::size_t index, const BodyShape* before);

/// The vertices of the mesh selected, counted within the body, ascending. Throws InputError with `pointer` where there
/// are none.
std::vector<int> selected_vertices(const Scene& scene, const BodyShape& shape, const scene::Selection& selection,
                                   const std::string& pointer);

}  // namespace taut
