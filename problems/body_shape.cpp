#include "problems/body_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "constraints/coupling.h"
#include "geometry/crossing.h"
#include "geometry/mesh_file.h"
#include "geometry/mesh_property.h"
#include "geometry/selection.h"
#include "geometry/topology.h"
#include "problems/cover_shape.h"

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
                 [](const MeshFile& file) { return std::pair(read_mesh(file.path), file.path.string()); },
                 [](const Refinement&) -> std::pair<TriangleMesh, std::string> {
                   throw std::logic_error("a refinement has no mesh of its own");
                 }},
      body.mesh);
}

TriangleMesh placed_mesh(const Body& body) {
  auto [mesh, label] = untransformed_mesh(body);
  for (Vector3& vertex : mesh.vertices) vertex = body.transform(vertex);
  validate(mesh, label);
  return std::move(mesh);
}

void place_solid(const Body& body, BodyShape& shape) {
  TetrahedronMesh solid = read_tetrahedra(std::get<MeshFile>(body.mesh).path);
  for (Vector3& vertex : solid.vertices) vertex = body.transform(vertex);
  shape.mesh.vertices = std::move(solid.vertices);
  shape.mesh.triangles = boundary_triangles(solid.cells);
  shape.tetrahedra = std::move(solid.cells);
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

/// The points of the top surface, placed as the bottom is.
std::vector<Vector3> placed_top(const Body& body, const TriangleMesh& bottom) {
  TriangleMesh top = read_mesh(body.shell->top);
  for (Vector3& vertex : top.vertices) vertex = body.transform(vertex);
  validate(top, body.shell->top.string());
  if (top.vertices.size() != bottom.vertices.size() || top.triangles != bottom.triangles)
    throw MeshError(body.shell->top.string() + ": found another mesh than the bottom's, allowed: the same triangles");
  return std::move(top.vertices);
}

/// One entry a prism through the thickness, from the bottom: its part of the thickness.
std::vector<double> fractions(const ThickShell& shell) {
  double thickness = 0;
  std::vector<double> parts;
  for (const Layer& layer : shell.layers) {
    thickness += layer.thickness;
    parts.insert(parts.end(), static_cast<std::size_t>(layer.prisms), layer.thickness / layer.prisms);
  }
  for (double& part : parts) part /= thickness;
  return parts;
}

/// One a vertex, or a single one, m.
std::vector<double> thicknesses(const Body& body, const TriangleMesh& mesh) {
  const ThickShell& shell = *body.shell;
  std::vector<double> values = shell.vertex_thickness;
  if (!shell.thickness_property.empty())
    values = read_vertex_property(std::get<MeshFile>(body.mesh).path, shell.thickness_property);
  if (values.empty()) {
    double sum = 0;
    for (const Layer& layer : shell.layers) sum += layer.thickness;
    return {sum};
  }
  if (values.size() != mesh.vertices.size()) {
    throw MeshError("found " + std::to_string(values.size()) + " thicknesses, allowed: one for each of the " +
                    std::to_string(mesh.vertices.size()) + " vertices");
  }
  for (std::size_t v = 0; v < values.size(); ++v) {
    if (!(values[v] > 0) || !std::isfinite(values[v]))
      throw MeshError("found the thickness " + std::to_string(values[v]) + " at vertex " + std::to_string(v) +
                      ", allowed: a number > 0");
  }
  return values;
}

/// Throws where the outer surfaces go through themselves or each other. Prisms that are nowhere inverted fill the space
/// between them once then.
void refuse_crossing(const LayeredMesh& layered, const TriangleMesh& mesh, const std::string& name) {
  const std::size_t triangles = mesh.triangles.size();
  std::vector<Triangle> surfaces;
  for (const int level : {0, layered.layers}) {
    for (const Triangle& t : mesh.triangles)
      surfaces.push_back({layered.node(t[0], level), layered.node(t[1], level), layered.node(t[2], level)});
  }
  const std::optional<Crossing> crossing = find_crossing(layered.nodes, surfaces);
  if (!crossing) return;
  const auto called = [&](int index) {
    const bool is_top = static_cast<std::size_t>(index) >= triangles;
    return std::string(is_top ? "top" : "bottom") + " of face " +
           std::to_string(static_cast<std::size_t>(index) % triangles);
  };
  const Triangle &first = surfaces[crossing->first], &second = surfaces[crossing->second];
  const Vector3 centroid = (layered.nodes[second[0]] + layered.nodes[second[1]] + layered.nodes[second[2]]) / 3;
  const int nearest = *std::min_element(first.begin(), first.end(), [&](int a, int b) {
    return (layered.nodes[a] - centroid).squaredNorm() < (layered.nodes[b] - centroid).squaredNorm();
  });
  throw MeshError(name + ": the " + called(crossing->first) + " goes through the " + called(crossing->second) +
                  " near vertex " + std::to_string(nearest / (layered.layers + 1)));
}

/// Nodes and surfaces of a thick shell; its mesh moves to the middle.
void add_layers(const Body& body, BodyShape& shape) {
  const ThickShell& shell = *body.shell;
  TriangleMesh& mesh = shape.mesh;
  if (shell.top.empty()) {
    shape.layered = make_layered(mesh, thicknesses(body, mesh), fractions(shell), body.name);
  } else {
    const std::vector<Vector3> top = placed_top(body, mesh);
    shape.layered = make_layered(mesh, mesh.vertices, top, fractions(shell), body.name);
    for (std::size_t v = 0; v < top.size(); ++v) mesh.vertices[v] = 0.5 * (mesh.vertices[v] + top[v]);
  }
  // The surfaces about a flat grid cannot cross.
  if (!shell.top.empty() || !std::holds_alternative<Grid>(body.mesh)) refuse_crossing(*shape.layered, mesh, body.name);
}

void find_rest_surfaces(BodyShape& shape) {
  shape.rest_positions = shape.mesh.vertices;
  const int top = shape.layered->layers;
  std::vector<Triangle> triangles;
  for (const Triangle& t : shape.mesh.triangles)
    triangles.push_back({t[0] * (top + 1), t[2] * (top + 1), t[1] * (top + 1)});
  for (const Triangle& t : shape.mesh.triangles)
    triangles.push_back({t[0] * (top + 1) + top, t[1] * (top + 1) + top, t[2] * (top + 1) + top});
  shape.rest = rest_triangles(triangles, shape.layered->nodes, shape.first_node);
}

void find_rest_shape(const Body& body, BodyShape& shape) {
  if (shape.layered) return find_rest_surfaces(shape);
  if (body.rest.from == RestShape::uv) {
    shape.rest_uv = scaled_uv(body, shape.mesh);
    shape.rest = rest_triangles(shape.mesh.triangles, shape.rest_uv, shape.first_node);
    return;
  }
  shape.rest_positions =
      body.rest.from == RestShape::mesh ? positions_of_rest_mesh(body, shape.mesh) : shape.mesh.vertices;
  for (Vector3& position : shape.rest_positions) position *= body.rest.scale;
  shape.rest = rest_triangles(shape.mesh.triangles, shape.rest_positions, shape.first_node);
}

/// Mesh, prolongation and carriers of a cover, with its imperfection.
void find_cover(const Body& body, const BodyShape& shell, BodyShape& shape) {
  const TriangleMesh surface = carrying_surface(shell, body.cover->surface);
  if (const auto* refinement = std::get_if<Refinement>(&body.mesh)) {
    std::tie(shape.mesh, shape.prolongation) = refine(surface, refinement->levels);
  } else {
    shape.mesh = placed_mesh(body);
    shape.prolongation = prolongation(surface, shape.mesh.vertices, body.name);
    right_inverse(surface, *shape.prolongation, body.name);  // throws where P is rank deficient
  }
  shape.carrying_triangles = surface.triangles;
  for (int v = 0; v < static_cast<int>(surface.vertices.size()); ++v)
    shape.carriers.push_back(shell.mean_nodes(v, body.cover->surface));
  if (body.cover->amplitude == 0) return;
  const std::vector<Vector3> bumps =
      imperfection(shape.mesh, *shape.prolongation, body.cover->amplitude, body.cover->seed);
  for (std::size_t i = 0; i < bumps.size(); ++i) shape.mesh.vertices[i] += bumps[i];
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

int BodyShape::level(Surface surface) const {
  switch (surface) {
    case Surface::bottom:
      return 0;
    case Surface::mid:
      return (levels() - 1) / 2;
    case Surface::top:
    case Surface::both:
      break;
  }
  return levels() - 1;
}

std::vector<int> BodyShape::nodes_at(int vertex, Surface surface) const {
  if (surface != Surface::both) return {node(vertex, level(surface))};
  std::vector<int> all;
  for (int at = 0; at < levels(); ++at) all.push_back(node(vertex, at));
  return all;
}

std::vector<int> BodyShape::mean_nodes(int vertex, Surface surface) const {
  const int low = (levels() - 1) / 2;
  if (surface == Surface::mid && layered && layered->layers % 2 == 1) return {node(vertex, low), node(vertex, low + 1)};
  return loaded_nodes(vertex, surface);
}

std::vector<int> BodyShape::loaded_nodes(int vertex, Surface surface) const {
  if (surface != Surface::both || !layered) return {node(vertex, level(surface))};
  return {node(vertex, 0), node(vertex, levels() - 1)};
}

BodyShape make_body_shape(const Scene& scene, std::size_t index, const BodyShape* before) {
  const Body& body = scene.bodies[index];
  const std::string pointer = "/bodies/" + body.name;
  BodyShape shape;
  shape.name = body.name;
  if (before) {
    shape.first_node = before->first_node + before->nodes();
    shape.first_triangle = before->first_triangle + static_cast<int>(before->rest.size());
  }
  try {
    if (body.cover)
      find_cover(body, *before, shape);
    else if (body.solid)
      place_solid(body, shape);
    else
      shape.mesh = placed_mesh(body);
    if (body.shell) add_layers(body, shape);
  } catch (const std::exception& error) {
    throw InputError(scene.source, pointer + "/mesh", error.what());
  }
  constexpr std::size_t most = std::numeric_limits<int>::max() / 3;  // three variables each, counted by an int
  const std::size_t nodes = shape.mesh.vertices.size() * static_cast<std::size_t>(shape.levels());
  if (nodes > most - static_cast<std::size_t>(shape.first_node)) {
    throw InputError(scene.source, pointer + "/mesh", "more than " + std::to_string(most) + " vertices in all");
  }
  try {
    find_rest_shape(body, shape);
  } catch (const std::exception& error) {
    throw InputError(scene.source, pointer + "/rest", error.what());
  }
  if (body.cover)
    make_compatible(*shape.prolongation, carrying_surface(*before, body.cover->surface).vertices, shape.mesh.vertices);
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
