#include "geometry/measures.h"

#include <Eigen/Geometry>
#include <stdexcept>

#include "geometry/topology.h"

namespace taut {

double triangle_area(const Vector3& a, const Vector3& b, const Vector3& c) { return 0.5 * (b - a).cross(c - a).norm(); }

std::vector<double> triangle_areas(const TriangleMesh& mesh) {
  std::vector<double> areas;
  areas.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    areas.push_back(triangle_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
  }
  return areas;
}

double bounding_box_diagonal(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return 0;
  Eigen::AlignedBox3d box;
  for (const Vector3& vertex : mesh.vertices) box.extend(vertex);
  return box.diagonal().norm();
}

double mean_edge_length(const TriangleMesh& mesh) {
  if (mesh.triangles.empty())
    throw std::invalid_argument("mean_edge_length: mesh has 0 triangles, expected at least 1");
  const std::vector<Edge> all = edges(mesh);
  double total = 0;
  for (const Edge& edge : all) total += (mesh.vertices[edge.v1] - mesh.vertices[edge.v0]).norm();
  return total / static_cast<double>(all.size());
}

}  // namespace taut
