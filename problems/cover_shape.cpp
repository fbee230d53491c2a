#include "problems/cover_shape.h"

#include <random>

#include "constraints/coupling.h"
#include "geometry/selection.h"

namespace taut {

TriangleMesh carrying_surface(const BodyShape& shell, scene::Surface surface) {
  TriangleMesh mesh = shell.mesh;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    if (!shell.layered) continue;
    Vector3 sum = Vector3::Zero();
    const std::vector<int> nodes = shell.mean_nodes(v, surface);
    for (const int node : nodes) sum += shell.layered->nodes[static_cast<std::size_t>(node - shell.first_node)];
    mesh.vertices[static_cast<std::size_t>(v)] = sum / static_cast<double>(nodes.size());
  }
  if (mesh.cells_x > 0) {
    for (const char* edge : {"x0", "x1", "y0", "y1"}) mesh.groups[edge] = select_edge(mesh, edge, shell.name);
    for (const char* corner : {"x0y0", "x1y0", "x0y1", "x1y1"})
      mesh.groups[corner] = select_corner(mesh, corner, shell.name);
  }
  return mesh;
}

std::vector<Vector3> imperfection(const TriangleMesh& mesh, const Prolongation& prolongation, double amplitude,
                                  unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<Vector3> bumps = vertex_normals(mesh);
  for (Vector3& bump : bumps) {
    const double share = static_cast<double>(generator()) / static_cast<double>(std::mt19937::max());
    bump *= amplitude * (2 * share - 1);
  }
  const std::vector<Vector3> none(static_cast<std::size_t>(prolongation.weights.cols()), Vector3::Zero());
  make_compatible(prolongation, none, bumps);
  return bumps;
}

}  // namespace taut
