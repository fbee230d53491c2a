#include "geometry/selection.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "geometry/measures.h"
#include "geometry/topology.h"

namespace taut {
namespace {

constexpr double relative_slack = 1e-9;  // of the bounding box's diagonal

std::string text(double value) {
  std::ostringstream out;
  out.precision(12);
  out << value;
  return out.str();
}

std::string text(const Vector3& v) { return "(" + text(v.x()) + ", " + text(v.y()) + ", " + text(v.z()) + ")"; }

std::string vertices_of(const TriangleMesh& mesh, const std::string& label) {
  return label + " (" + std::to_string(mesh.vertices.size()) + " vertices)";
}

std::vector<int> require_some(std::vector<int> selected, const std::string& what, const TriangleMesh& mesh,
                              const std::string& label) {
  if (selected.empty()) throw SelectionError(what + " selects no vertex of " + vertices_of(mesh, label));
  return selected;
}

void require_grid(const TriangleMesh& mesh, const std::string& what, const std::string& label) {
  if (mesh.cells_x < 1 || mesh.cells_y < 1)
    throw SelectionError(what + " is for grids, and " + vertices_of(mesh, label) + " is not one");
}

template <class Predicate>
std::vector<int> vertices_where(const TriangleMesh& mesh, Predicate&& chosen) {
  std::vector<int> selected;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) {
    if (chosen(mesh.vertices[v])) selected.push_back(v);
  }
  return selected;
}

/// `count` vertices from `first` on, `stride` apart.
std::vector<int> every(int first, int stride, int count) {
  std::vector<int> selected(count);
  for (int k = 0; k < count; ++k) selected[k] = first + k * stride;
  return selected;
}

}  // namespace

std::vector<int> select_indices(const TriangleMesh& mesh, std::span<const int> indices, const std::string& label) {
  for (const int v : indices) {
    if (v < 0 || v >= static_cast<int>(mesh.vertices.size())) {
      throw SelectionError("vertex " + std::to_string(v) + " is not one of " + vertices_of(mesh, label));
    }
  }
  std::vector<int> selected(indices.begin(), indices.end());
  std::sort(selected.begin(), selected.end());
  selected.erase(std::unique(selected.begin(), selected.end()), selected.end());
  return require_some(std::move(selected), "an empty list of vertices", mesh, label);
}

std::vector<int> select_corner(const TriangleMesh& mesh, const std::string& name, const std::string& label) {
  if (name != "x0y0" && name != "x1y0" && name != "x0y1" && name != "x1y1") {
    throw std::invalid_argument("select_corner: name is \"" + name + "\", expected x0y0, x1y0, x0y1 or x1y1");
  }
  require_grid(mesh, "corner " + name, label);
  const int i = name[1] == '1' ? mesh.cells_x : 0, j = name[3] == '1' ? mesh.cells_y : 0;
  return {j * (mesh.cells_x + 1) + i};
}

std::vector<int> select_edge(const TriangleMesh& mesh, const std::string& name, const std::string& label) {
  if (name != "x0" && name != "x1" && name != "y0" && name != "y1") {
    throw std::invalid_argument("select_edge: name is \"" + name + "\", expected x0, x1, y0 or y1");
  }
  require_grid(mesh, "edge " + name, label);
  const int stride = mesh.cells_x + 1;
  if (name == "x0") return every(0, stride, mesh.cells_y + 1);
  if (name == "x1") return every(mesh.cells_x, stride, mesh.cells_y + 1);
  return every(name == "y0" ? 0 : mesh.cells_y * stride, 1, stride);
}

std::vector<int> select_box(const TriangleMesh& mesh, const Vector3& low, const Vector3& high,
                            const std::string& label) {
  if (!(low.array() <= high.array()).all()) {
    throw std::invalid_argument("select_box: low is " + text(low) + " and high is " + text(high) +
                                ", expected low <= high on every axis");
  }
  const double slack = relative_slack * bounding_box_diagonal(mesh);
  auto inside = [&](const Vector3& p) {
    return (p.array() >= low.array() - slack).all() && (p.array() <= high.array() + slack).all();
  };
  return require_some(vertices_where(mesh, inside), "the box from " + text(low) + " to " + text(high), mesh, label);
}

std::vector<int> select_sphere(const TriangleMesh& mesh, const Vector3& center, double radius,
                               const std::string& label) {
  if (!(radius >= 0) || !center.allFinite()) {
    throw std::invalid_argument("select_sphere: center is " + text(center) + " and radius " + text(radius) +
                                ", expected finite and not negative");
  }
  const double reach = radius + relative_slack * bounding_box_diagonal(mesh);
  auto inside = [&](const Vector3& p) { return (p - center).norm() <= reach; };
  return require_some(vertices_where(mesh, inside), "the sphere around " + text(center) + " of radius " + text(radius),
                      mesh, label);
}

std::vector<int> select_nearest(const TriangleMesh& mesh, const Vector3& point, const std::string& label) {
  if (!point.allFinite())
    throw std::invalid_argument("select_nearest: point is " + text(point) + ", expected finite coordinates");
  const auto nearer = [&](const Vector3& a, const Vector3& b) {
    return (a - point).squaredNorm() < (b - point).squaredNorm();
  };
  const auto nearest = std::min_element(mesh.vertices.begin(), mesh.vertices.end(), nearer);
  std::vector<int> selected;
  if (nearest != mesh.vertices.end()) selected.push_back(static_cast<int>(nearest - mesh.vertices.begin()));
  return require_some(std::move(selected), "the vertex nearest to " + text(point), mesh, label);
}

std::vector<int> select_boundary(const TriangleMesh& mesh, const std::string& label) {
  return require_some(boundary_vertices(mesh), "the boundary", mesh, label);
}

std::vector<int> select_group(const TriangleMesh& mesh, const std::string& name, const std::string& label) {
  const auto group = mesh.groups.find(name);
  if (group == mesh.groups.end()) {
    std::string known;
    for (const auto& entry : mesh.groups) known += (known.empty() ? "; it has " : ", ") + ("\"" + entry.first + "\"");
    throw SelectionError("there is no group \"" + name + "\" in " + vertices_of(mesh, label) +
                         (known.empty() ? "; it has no groups" : known));
  }
  return require_some(group->second, "group \"" + name + "\"", mesh, label);
}

std::vector<int> select_all(const TriangleMesh& mesh, const std::string& label) {
  std::vector<int> selected(mesh.vertices.size());
  std::iota(selected.begin(), selected.end(), 0);
  return require_some(std::move(selected), "all", mesh, label);
}

}  // namespace taut
