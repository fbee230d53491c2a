#include "geometry/layered_mesh.h"

#include <cmath>
#include <numeric>
#include <stdexcept>

#include "geometry/topology.h"

namespace taut {
namespace {

void check_sizes(const TriangleMesh& mesh, const std::vector<Vector3>& bottom, const std::vector<Vector3>& top,
                 const std::vector<double>& fractions) {
  const std::size_t vertices = mesh.vertices.size();
  if (bottom.size() != vertices || top.size() != vertices) {
    throw std::invalid_argument("make_layered: expected " + std::to_string(vertices) + " points a surface, got " +
                                std::to_string(bottom.size()) + " and " + std::to_string(top.size()));
  }
  if (fractions.empty()) throw std::invalid_argument("make_layered: expected at least one layer, got none");
  for (double fraction : fractions) {
    if (!(fraction > 0)) {
      throw std::invalid_argument("make_layered: expected positive fractions, got " + std::to_string(fraction));
    }
  }
  const double sum = std::accumulate(fractions.begin(), fractions.end(), 0.0);
  if (!(std::abs(sum - 1) < 1e-9)) {
    throw std::invalid_argument("make_layered: expected fractions with sum 1, got " + std::to_string(sum));
  }
}

void refuse_inverted(const LayeredMesh& layered, const TriangleMesh& mesh, const std::string& label) {
  const std::size_t triangles = mesh.triangles.size();
  for (std::size_t p = 0; p < layered.prisms.size(); ++p) {
    std::array<Vector3, 6> points;
    for (int j = 0; j < 6; ++j) points[j] = layered.nodes[layered.prisms[p][j]];
    int corner = 0;
    if (PrismJacobian(PrismShape(points)).smallest(&corner) > 0) continue;
    const Triangle& t = mesh.triangles[p % triangles];
    throw MeshError(label + ": face " + std::to_string(p % triangles) + ", layer " + std::to_string(p / triangles) +
                    " (vertices " + std::to_string(t[0]) + ", " + std::to_string(t[1]) + ", " + std::to_string(t[2]) +
                    "): inverted at vertex " + std::to_string(t[corner]));
  }
}

}  // namespace

std::vector<Vector3> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Vector3> normals(mesh.vertices.size(), Vector3::Zero());
  for (const Triangle& triangle : mesh.triangles) {
    for (int j = 0; j < 3; ++j) {
      const Vector3& corner = mesh.vertices[triangle[j]];
      const Vector3 to_next = mesh.vertices[triangle[(j + 1) % 3]] - corner;
      const Vector3 to_last = mesh.vertices[triangle[(j + 2) % 3]] - corner;
      const Vector3 across = to_next.cross(to_last);
      normals[triangle[j]] += std::atan2(across.norm(), to_next.dot(to_last)) * across.normalized();
    }
  }
  for (Vector3& normal : normals) normal.normalize();
  return normals;
}

LayeredMesh make_layered(const TriangleMesh& mesh, const std::vector<Vector3>& bottom, const std::vector<Vector3>& top,
                         const std::vector<double>& fractions, const std::string& label) {
  check_sizes(mesh, bottom, top, fractions);
  LayeredMesh layered;
  layered.layers = static_cast<int>(fractions.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    double height = 0;
    for (int level = 0; level <= layered.layers; ++level) {
      // The last level is the top exactly, whatever the sum of the fractions rounds to.
      layered.nodes.push_back(level == layered.layers ? top[v] : Vector3((1 - height) * bottom[v] + height * top[v]));
      if (level < layered.layers) height += fractions[level];
    }
  }
  for (int layer = 0; layer < layered.layers; ++layer) {
    for (const Triangle& triangle : mesh.triangles) {
      Prism prism;
      for (int j = 0; j < 3; ++j) {
        prism[2 * j] = layered.node(triangle[j], layer);
        prism[2 * j + 1] = layered.node(triangle[j], layer + 1);
      }
      layered.prisms.push_back(prism);
    }
  }
  refuse_inverted(layered, mesh, label);
  return layered;
}

LayeredMesh make_layered(const TriangleMesh& mesh, const std::vector<double>& thickness,
                         const std::vector<double>& fractions, const std::string& label) {
  const std::size_t vertices = mesh.vertices.size();
  if (thickness.size() != 1 && thickness.size() != vertices) {
    throw std::invalid_argument("make_layered: expected 1 or " + std::to_string(vertices) + " thicknesses, got " +
                                std::to_string(thickness.size()));
  }
  const std::vector<Vector3> normals = vertex_normals(mesh);
  std::vector<Vector3> bottom = mesh.vertices, top = mesh.vertices;
  for (std::size_t v = 0; v < vertices; ++v) {
    const double t = thickness[thickness.size() == 1 ? 0 : v];
    if (!(t > 0)) {
      throw std::invalid_argument("make_layered: expected positive thicknesses, got " + std::to_string(t));
    }
    bottom[v] -= 0.5 * t * normals[v];
    top[v] += 0.5 * t * normals[v];
  }
  return make_layered(mesh, bottom, top, fractions, label);
}

}  // namespace taut
