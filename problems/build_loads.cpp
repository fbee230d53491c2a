#include <algorithm>

#include "energies/wind.h"
#include "geometry/topology.h"
#include "problems/build_parts.h"

namespace taut {
namespace {

std::string pointer_to(const scene::Load& load) { return "/loads/" + load.name; }

/// M g, so that bodies fall alike whatever their mass matrix.
Vector gravity_forces(const Model& model, const Vector3& gravity) {
  const Vector acceleration = gravity.replicate(model.positions.size() / 3, 1);
  Vector forces = Vector::Zero(model.positions.size());
  for (const auto& inertia : model.inertia) inertia->add_product(acceleration, forces);
  return forces;
}

Vector point_forces(const Scene& scene, const scene::Load& load, const scene::PointLoad& point, const BodyShape& shape,
                    Index size) {
  Vector forces = Vector::Zero(size);
  for (const int vertex : selected_vertices(scene, shape, point.select, pointer_to(load) + "/select")) {
    forces.segment<3>(3 * (shape.first_vertex + vertex)) = point.force;
  }
  return forces;
}

/// Half of each loaded edge's force at each of its ends.
Vector edge_forces(const Scene& scene, const scene::Load& load, const scene::EdgeLoad& edge_load,
                   const BodyShape& shape, Index size) {
  const std::string pointer = pointer_to(load) + "/select";
  const std::vector<int> selected = selected_vertices(scene, shape, edge_load.select, pointer);
  const auto is_selected = [&](int vertex) { return std::binary_search(selected.begin(), selected.end(), vertex); };
  Vector forces = Vector::Zero(size);
  bool any = false;
  for (const Edge& edge : edges(shape.mesh)) {
    if (edge.right >= 0 || !is_selected(edge.v0) || !is_selected(edge.v1)) continue;
    any = true;
    const Triangle& triangle = shape.mesh.triangles[edge.left];
    const int corner = static_cast<int>(std::find(triangle.begin(), triangle.end(), edge.v0) - triangle.begin());
    const Vector3 half = 0.5 * shape.rest_edge_length(edge.left, corner) * edge_load.force_per_length;
    for (const int vertex : {edge.v0, edge.v1}) forces.segment<3>(3 * (shape.first_vertex + vertex)) += half;
  }
  if (!any) {
    throw InputError(scene.source, pointer,
                     "found " + std::to_string(selected.size()) + " vertices of " + shape.name +
                         " and no boundary edge among them, allowed: a selection with both ends of at least one");
  }
  return forces;
}

std::vector<Triangle> scene_triangles(const BodyShape& shape) {
  std::vector<Triangle> triangles;
  for (const RestTriangle& rest : shape.rest) triangles.push_back(rest.vertices);
  return triangles;
}

/// p V is a potential of the pressure where no part of the boundary can move: its forces do not depend on the origin of
/// V then.
void require_potential(const Scene& scene, const scene::Load& load, const BodyShape& shape, const Model& model) {
  for (const int vertex : boundary_vertices(shape.mesh)) {
    for (int axis = 0; axis < 3; ++axis) {
      const int variable = 3 * (shape.first_vertex + vertex) + axis;
      const auto pin = std::lower_bound(model.pins.begin(), model.pins.end(), variable,
                                        [](const PinnedVariable& p, int v) { return p.variable < v; });
      if (pin != model.pins.end() && pin->variable == variable) continue;
      throw InputError(scene.source, pointer_to(load),
                       "found a boundary vertex of " + shape.name + " that can move (" + std::to_string(vertex) +
                           ", along " + "xyz"[axis] +
                           "), where pressure times volume is no potential; allowed: a closed mesh, or pins on all "
                           "axes of the whole boundary");
    }
  }
}

}  // namespace

void add_loads(const Scene& scene, const std::vector<BodyShape>& shapes, Model& model) {
  const Index size = model.positions.size();
  const auto add_dead_load = [&](const std::string& name, Vector forces) {
    model.dead_loads.push_back(std::make_unique<DeadLoad>(name, std::move(forces)));
  };
  if (!scene.gravity.isZero(0)) add_dead_load("gravity", gravity_forces(model, scene.gravity));
  for (const scene::Load& load : scene.loads) {
    const BodyShape& shape = shapes[load.body];
    if (const auto* point = std::get_if<scene::PointLoad>(&load.kind)) {
      add_dead_load(load.name, point_forces(scene, load, *point, shape, size));
    } else if (const auto* edge = std::get_if<scene::EdgeLoad>(&load.kind)) {
      add_dead_load(load.name, edge_forces(scene, load, *edge, shape, size));
    } else if (const auto* pressure = std::get_if<scene::Pressure>(&load.kind)) {
      require_potential(scene, load, shape, model);
      model.pressures.push_back(std::make_unique<Pressure>(load.name, scene_triangles(shape), pressure->pressure));
    } else {
      const auto& air = std::get<scene::Wind>(load.kind);
      const Wind wind{air.velocity, air.air_density, air.drag};
      model.lagged_loads.push_back({std::make_unique<DeadLoad>(load.name, Vector::Zero(size), true),
                                    [wind, triangles = scene_triangles(shape)](
                                        const Vector& positions, const Vector& velocities, Vector& forces) {
                                      add_wind(wind, triangles, 0, positions, velocities, forces);
                                    }});
    }
  }
}

}  // namespace taut
