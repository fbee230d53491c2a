#pragma once

#include <string>
#include <vector>

#include "geometry/prism.h"
#include "geometry/triangle_mesh.h"

namespace taut {

/// Prisms stacked on a triangle mesh: `layers` of them on every triangle, bonded by the nodes they share. The nodes of
/// mid-surface vertex v are v (layers + 1) + level, from the bottom (level 0) to the top.
struct LayeredMesh {
  int layers = 1;
  std::vector<Vector3> nodes;  ///< m
  std::vector<Prism> prisms;   ///< prism of triangle t in layer l, from the bottom: l x triangles + t

  int node(int vertex, int level) const { return vertex * (layers + 1) + level; }
};

/// Unit normals at the vertices of a surface: those of the triangles around, weighted by their angles.
std::vector<Vector3> vertex_normals(const TriangleMesh& mesh);

/// Prisms between two surfaces with the triangles of `mesh`. `bottom` and `top` have a point per vertex, in m;
/// `fractions` says which part of the thickness each layer has, from the bottom, and sums to 1.
///
/// Throws MeshError at the first prism that is inverted or flat anywhere inside (the exact test), as "shell: face 17,
/// layer 0 (vertices 3, 4, 5): inverted at vertex 4"; `label` names the mesh.
LayeredMesh make_layered(const TriangleMesh& mesh, const std::vector<Vector3>& bottom, const std::vector<Vector3>& top,
                         const std::vector<double>& fractions, const std::string& label);

/// The same about the mid-surface `mesh`, half of `thickness` (m: one value per vertex, or a single one) to either side
/// along vertex_normals().
LayeredMesh make_layered(const TriangleMesh& mesh, const std::vector<double>& thickness,
                         const std::vector<double>& fractions, const std::string& label);

}  // namespace taut
