#include "problems/body_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/mesh_file.h"
#include "geometry/selection.h"
#include "geometry/topology.h"

namespace taut {
namespace {

using namespace scene;

template <class... Functions>
struct Overloaded : Functions... {
  using Functions::operator()...;
};

/// The mesh as the file or the grid has it, and how messages call it.
std::pair<TriangleMesh, std::string> untransformed_mesh(const Body& body) {
  return std::visit(
      Overloaded{[&](const Grid& grid) {
                   return std::pair(make_grid(grid.size.x(), grid.size.y(), grid.cells_x, grid.cells_y, grid.diagonals),
                                    body.name);
                 },
                 [](const MeshFile& file) { return std::pair(read_mesh(file.path), file.path.string()); }},
      body.mesh);
}

TriangleMesh placed_mesh(const Body& body) {
  auto [mesh, label] = untransformed_mesh(body);
  for (Vector3& vertex : mesh.vertices) vertex = body.transform(vertex);
  validate(mesh, label);
  return std::move(mesh);
}

/// Positions of a second mesh, which has the triangles of the first.
std::vector<Vector3> positions_of_rest_mesh(const Body& body, const TriangleMesh& mesh) {
  const TriangleMesh second = read_mesh(body.rest.file);
  validate(second, body.rest.file.string());
  if (second.vertices.size() != mesh.vertices.size() || second.triangles != mesh.triangles) {
    throw MeshError(body.rest.file.string() + ": found " + std::to_string(second.vertices.size()) + " vertices and " +
                    std::to_string(second.triangles.size()) +
                    " triangles, allowed: the same triangles as the body's mesh (" +
                    std::to_string(mesh.vertices.size()) + " vertices, " + std::to_string(mesh.triangles.size()) +
                    " triangles, corners in the same order)");
  }
  return second.vertices;
}

std::vector<std::array<Vector2, 3>> scaled_uv(const Body& body, const TriangleMesh& mesh) {
  if (mesh.corner_uv.empty())
    throw MeshError("found a mesh without uv, allowed: one where every face has texture coordinates");
  std::vector<std::array<Vector2, 3>> uv = mesh.corner_uv;
  for (std::size_t t = 0; t < uv.size(); ++t) {
    for (Vector2& corner : uv[t]) corner *= body.rest.scale;
    const Vector2 e1 = uv[t][1] - uv[t][0], e2 = uv[t][2] - uv[t][0];
    const double longest = std::max({e1.squaredNorm(), e2.squaredNorm(), (e2 - e1).squaredNorm()});
    const double area = 0.5 * std::abs(e1.x() * e2.y() - e1.y() * e2.x());
    if (!(area > 1e-12 * longest) || !std::isfinite(longest))
      throw MeshError("triangle " + std::to_string(t) + " has no area in uv");
  }
  return uv;
}

void find_rest_shape(const Body& body, BodyShape& shape) {
  if (body.rest.from == RestShape::uv) {
    shape.rest_uv = scaled_uv(body, shape.mesh);
    shape.rest = rest_triangles(shape.mesh.triangles, shape.rest_uv, shape.first_vertex);
    return;
  }
  shape.rest_positions =
      body.rest.from == RestShape::mesh ? positions_of_rest_mesh(body, shape.mesh) : shape.mesh.vertices;
  for (Vector3& position : shape.rest_positions) position *= body.rest.scale;
  shape.rest = rest_triangles(shape.mesh.triangles, shape.rest_positions, shape.first_vertex);
}

template <class Names, class Select>
std::vector<int> union_of(const Names& names, Select&& select) {
  std::vector<int> all;
  for (const auto& name : names) {
    const std::vector<int> more = select(name);
    all.insert(all.end(), more.begin(), more.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

double BodyShape::rest_edge_length(int triangle, int k) const {
  const int next = (k + 1) % 3;
  if (!rest_uv.empty()) return (rest_uv[triangle][next] - rest_uv[triangle][k]).norm();
  const Triangle& corners = mesh.triangles[triangle];
  return (rest_positions[corners[next]] - rest_positions[corners[k]]).norm();
}

BodyShape make_body_shape(const Scene& scene, std::size_t index, const BodyShape* before) {
  const Body& body = scene.bodies[index];
  const std::string pointer = "/bodies/" + body.name;
  BodyShape shape;
  shape.name = body.name;
  if (before) {
    shape.first_vertex = before->first_vertex + static_cast<int>(before->mesh.vertices.size());
    shape.first_triangle = before->first_triangle + static_cast<int>(before->mesh.triangles.size());
  }
  try {
    shape.mesh = placed_mesh(body);
  } catch (const std::exception& error) {
    throw InputError(scene.source, pointer + "/mesh", error.what());
  }
  constexpr std::size_t most = std::numeric_limits<int>::max() / 3;  // three variables each, counted by an int
  if (shape.mesh.vertices.size() > most - static_cast<std::size_t>(shape.first_vertex)) {
    throw InputError(scene.source, pointer + "/mesh", "more than " + std::to_string(most) + " vertices in all");
  }
  try {
    find_rest_shape(body, shape);
  } catch (const std::exception& error) {
    throw InputError(scene.source, pointer + "/rest", error.what());
  }
  return shape;
}

std::vector<int> selected_vertices(const Scene& scene, const BodyShape& shape, const Selection& selection,
                                   const std::string& pointer) {
  const TriangleMesh& mesh = shape.mesh;
  const std::string& label = shape.name;
  try {
    return std::visit(
        Overloaded{
            [&](const Everything&) { return select_all(mesh, label); },
            [&](const ByIndex& by) { return select_indices(mesh, by.vertices, label); },
            [&](const AtCorners& at) {
              return union_of(at.names, [&](const std::string& name) { return select_corner(mesh, name, label); });
            },
            [&](const OnEdges& on) {
              return union_of(on.names, [&](const std::string& name) { return select_edge(mesh, name, label); });
            },
            [&](const InBox& box) { return select_box(mesh, box.min, box.max, label); },
            [&](const InBall& ball) { return select_sphere(mesh, ball.center, ball.radius, label); },
            [&](const NearestTo& to) {
              return union_of(to.points, [&](const Vector3& point) { return select_nearest(mesh, point, label); });
            },
            [&](const InGroup& in) { return select_group(mesh, in.name, label); },
            [&](const OnBoundary&) { return select_boundary(mesh, label); },
        },
        selection);
  } catch (const SelectionError& error) {
    throw InputError(scene.source, pointer, error.what());
  }
}

}  // namespace taut
