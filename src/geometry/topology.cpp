#include "geometry/topology.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>

#include "geometry/measures.h"

namespace taut {
namespace {

constexpr double smallest_relative_area = 1e-12;  // of the longest edge squared

[[noreturn]] void refuse_face(const TriangleMesh& mesh, const std::string& label, int face, const std::string& why) {
  const Triangle& t = mesh.triangles[face];
  throw MeshError(label + ": face " + std::to_string(face) + " (vertices " + std::to_string(t[0]) + ", " +
                  std::to_string(t[1]) + ", " + std::to_string(t[2]) + "): " + why);
}

std::uint64_t edge_key(int a, int b) {
  const auto [low, high] = std::minmax(a, b);
  return static_cast<std::uint64_t>(low) << 32 | static_cast<std::uint32_t>(high);
}

std::vector<Edge> collect_edges(const TriangleMesh& mesh, const std::string& label) {
  std::vector<Edge> result;
  std::unordered_map<std::uint64_t, std::size_t> seen;
  result.reserve(mesh.triangles.size() * 3 / 2 + 1);
  seen.reserve(mesh.triangles.size() * 3 / 2 + 1);
  for (int face = 0; face < static_cast<int>(mesh.triangles.size()); ++face) {
    const Triangle& t = mesh.triangles[face];
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3], opposite = t[(k + 2) % 3];
      const auto [entry, is_new] = seen.try_emplace(edge_key(a, b), result.size());
      if (is_new) {
        result.push_back({a, b, face, -1, opposite, -1});
        continue;
      }
      Edge& edge = result[entry->second];
      const std::string name = "edge " + std::to_string(edge.v0) + "-" + std::to_string(edge.v1);
      if (edge.right >= 0) {
        refuse_face(mesh, label, face,
                    "third face on " + name + ", after faces " + std::to_string(edge.left) + " and " +
                        std::to_string(edge.right));
      }
      if (edge.v0 == a) {
        refuse_face(mesh, label, face,
                    "runs through " + name + " the same way as face " + std::to_string(edge.left) +
                        " (inconsistent orientation)");
      }
      edge.right = face;
      edge.opposite_right = opposite;
    }
  }
  return result;
}

void validate_vertices(const TriangleMesh& mesh, const std::string& label) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!mesh.vertices[v].allFinite())
      throw MeshError(label + ": vertex " + std::to_string(v) + ": coordinates are not finite");
  }
}

void validate_face(const TriangleMesh& mesh, const std::string& label, int face) {
  const Triangle& t = mesh.triangles[face];
  const int count = static_cast<int>(mesh.vertices.size());
  for (const int v : t) {
    if (v < 0 || v >= count) {
      refuse_face(
          mesh, label, face,
          "vertex " + std::to_string(v) + " is out of range, the mesh has " + std::to_string(count) + " vertices");
    }
  }
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) refuse_face(mesh, label, face, "repeated vertex");
  const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const double area = triangle_area(a, b, c);
  const double longest_squared = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  if (!std::isfinite(area) || !std::isfinite(longest_squared)) refuse_face(mesh, label, face, "area is not finite");
  if (area <= smallest_relative_area * longest_squared) refuse_face(mesh, label, face, "zero area");
}

void validate_no_duplicates(const TriangleMesh& mesh, const std::string& label) {
  std::map<Triangle, int> seen;
  for (int face = 0; face < static_cast<int>(mesh.triangles.size()); ++face) {
    Triangle sorted = mesh.triangles[face];
    std::sort(sorted.begin(), sorted.end());
    const auto [first, is_new] = seen.try_emplace(sorted, face);
    if (!is_new) refuse_face(mesh, label, face, "duplicate of face " + std::to_string(first->second));
  }
}

void validate_all_used(const TriangleMesh& mesh, const std::string& label) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const int v : t) used[v] = true;
  }
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused != used.end()) {
    throw MeshError(label + ": vertex " + std::to_string(unused - used.begin()) + ": used by no face (" +
                    std::to_string(std::count(unused, used.end(), false)) + " such in all)");
  }
}

}  // namespace

std::vector<Edge> edges(const TriangleMesh& mesh) { return collect_edges(mesh, "mesh"); }

std::vector<int> boundary_vertices(const TriangleMesh& mesh) {
  std::vector<int> result;
  for (const Edge& edge : edges(mesh)) {
    if (edge.right < 0) result.insert(result.end(), {edge.v0, edge.v1});
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

bool is_closed(const TriangleMesh& mesh) {
  const std::vector<Edge> all = edges(mesh);
  return !all.empty() && std::none_of(all.begin(), all.end(), [](const Edge& edge) { return edge.right < 0; });
}

void validate(const TriangleMesh& mesh, const std::string& label) {
  if (mesh.triangles.empty()) throw MeshError(label + ": no faces");
  validate_vertices(mesh, label);
  for (int face = 0; face < static_cast<int>(mesh.triangles.size()); ++face) validate_face(mesh, label, face);
  validate_no_duplicates(mesh, label);
  collect_edges(mesh, label);
  validate_all_used(mesh, label);
}

}  // namespace taut
