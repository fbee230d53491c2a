#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

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

/// Adds a force at a vertex to the nodes that share it.
void add_force(const BodyShape& shape, int vertex, scene::Surface surface, const Vector3& force, Vector& forces) {
  const std::vector<int> nodes = shape.loaded_nodes(vertex, surface);
  for (const int node : nodes) forces.segment<3>(3 * node) += force / static_cast<double>(nodes.size());
}

Vector point_forces(const Scene& scene, const scene::Load& load, const scene::PointLoad& point, const BodyShape& shape,
                    Index size) {
  Vector forces = Vector::Zero(size);
  for (const int vertex : selected_vertices(scene, shape, point.select, pointer_to(load) + "/select")) {
    add_force(shape, vertex, load.surface, point.force, forces);
  }
  return forces;
}

/// The length of edges that is at each vertex, half of each selected boundary edge: vertex and m.
std::vector<std::pair<int, double>> edge_lengths(const Scene& scene, const std::string& pointer,
                                                 const scene::Selection& select, const BodyShape& shape) {
  const std::vector<int> selected = selected_vertices(scene, shape, select, pointer);
  const auto is_selected = [&](int vertex) { return std::binary_search(selected.begin(), selected.end(), vertex); };
  std::vector<std::pair<int, double>> lengths;
  for (const Edge& edge : edges(shape.mesh)) {
    if (edge.right >= 0 || !is_selected(edge.v0) || !is_selected(edge.v1)) continue;
    const Triangle& triangle = shape.mesh.triangles[edge.left];
    const int corner = static_cast<int>(std::find(triangle.begin(), triangle.end(), edge.v0) - triangle.begin());
    const double half = 0.5 * shape.rest_edge_length(edge.left, corner);
    for (const int vertex : {edge.v0, edge.v1}) lengths.emplace_back(vertex, half);
  }
  if (lengths.empty()) {
    throw InputError(scene.source, pointer,
                     "found " + std::to_string(selected.size()) + " vertices of " + shape.name +
                         " and no boundary edge among them, allowed: a selection with both ends of at least one");
  }
  return lengths;
}

Vector edge_forces(const Scene& scene, const scene::Load& load, const scene::EdgeLoad& edge_load,
                   const BodyShape& shape, Index size) {
  Vector forces = Vector::Zero(size);
  for (const auto& [vertex, length] : edge_lengths(scene, pointer_to(load) + "/select", edge_load.select, shape)) {
    add_force(shape, vertex, load.surface, length * edge_load.force_per_length, forces);
  }
  return forces;
}

/// Rest area of a triangle of the mesh, in the middle of a thick shell, m^2.
double middle_area(const BodyShape& shape, std::size_t triangle) {
  if (!shape.layered) return shape.rest[triangle].area;
  const Triangle& t = shape.mesh.triangles[triangle];
  const std::vector<Vector3>& x = shape.rest_positions;
  return 0.5 * (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).norm();
}

/// A third of each triangle's force at each of its vertices.
Vector surface_forces(const scene::Load& load, const scene::SurfaceLoad& surface_load, const BodyShape& shape,
                      Index size) {
  Vector forces = Vector::Zero(size);
  for (std::size_t t = 0; t < shape.mesh.triangles.size(); ++t) {
    const Triangle& triangle = shape.mesh.triangles[t];
    for (const int vertex : triangle) {
      double factor = middle_area(shape, t) / 3;
      for (const Vector3& wave : surface_load.half_waves)
        factor *= std::sin(std::numbers::pi * wave.dot(shape.mesh.vertices[vertex]));
      add_force(shape, vertex, load.surface, factor * surface_load.force_per_area, forces);
    }
  }
  return forces;
}

std::unique_ptr<EndMoment> end_moment(const Scene& scene, const scene::Load& load, const scene::EndMoment& moment,
                                      const BodyShape& shape, const Vector& positions) {
  std::map<int, double> lengths;
  for (const auto& [vertex, length] : edge_lengths(scene, pointer_to(load) + "/select", moment.select, shape))
    lengths[vertex] += length;
  std::vector<EndMoment::Load> loads;
  for (const auto& [vertex, length] : lengths) {
    loads.push_back(
        {shape.node(vertex, 0), shape.node(vertex, shape.levels() - 1), length * moment.moment_per_length.norm()});
  }
  try {
    return std::make_unique<EndMoment>(load.name, std::move(loads), moment.moment_per_length, positions);
  } catch (const std::invalid_argument&) {
    throw InputError(scene.source, pointer_to(load) + "/moment_per_length",
                     "found an axis along the thickness of " + shape.name + ", allowed: one across it");
  }
}

/// The mesh's triangles on a surface, for pressure and wind, which see one surface of a thick shell.
std::vector<Triangle> pressed_triangles(const BodyShape& shape, scene::Surface surface) {
  std::vector<Triangle> triangles;
  for (const Triangle& t : shape.mesh.triangles) {
    const int level = shape.layered ? shape.level(surface) : 0;
    triangles.push_back({shape.node(t[0], level), shape.node(t[1], level), shape.node(t[2], level)});
  }
  return triangles;
}

/// A boundary vertex that can move and the axis along which it can, as text; empty where there is none. p V is a
/// potential of the pressure only then: its forces do not depend on the origin of V.
std::string free_boundary(const scene::Load& load, const BodyShape& shape, const Model& model) {
  for (const int vertex : boundary_vertices(shape.mesh)) {
    for (int axis = 0; axis < 3; ++axis) {
      const int variable = 3 * shape.node(vertex, shape.layered ? shape.level(load.surface) : 0) + axis;
      const auto pin = std::lower_bound(model.pins.begin(), model.pins.end(), variable,
                                        [](const PinnedVariable& p, int v) { return p.variable < v; });
      if (pin != model.pins.end() && pin->variable == variable) continue;
      return "vertex " + std::to_string(vertex) + " of " + shape.name + " along " + "xyz"[axis];
    }
  }
  return "";
}

/// Adds the forces of a pressure at these positions, a third of each triangle's to each of its vertices.
void add_pressure_forces(double pressure, const std::vector<Triangle>& triangles, const Vector& x, Vector& forces) {
  for (const Triangle& t : triangles) {
    const Vector3 origin = x.segment<3>(3 * t[0]);
    const Vector3 area = 0.5 * (x.segment<3>(3 * t[1]) - origin).cross(x.segment<3>(3 * t[2]) - origin);
    for (const int vertex : t) forces.segment<3>(3 * vertex) += pressure / 3 * area;
  }
}

/// Dead, with a potential, or lagged.
void add_pressure(const scene::Load& load, const scene::Pressure& pressure, const BodyShape& shape, Model& model) {
  const std::vector<Triangle> triangles = pressed_triangles(shape, load.surface);
  const double size = pressure.pressure;
  if (!pressure.follows) {
    Vector forces = Vector::Zero(model.positions.size());
    add_pressure_forces(size, triangles, model.positions, forces);
    model.dead_loads.push_back(std::make_unique<DeadLoad>(load.name, std::move(forces)));
    return;
  }
  const std::string free = free_boundary(load, shape, model);
  if (free.empty()) {
    model.pressures.push_back(std::make_unique<Pressure>(load.name, triangles, size));
    return;
  }
  model.notes.push_back("pressure " + load.name + " has no potential, because the boundary can move (" + free +
                        "): in each step its forces are those of the step's start");
  Vector at_rest = Vector::Zero(model.positions.size());
  add_pressure_forces(size, triangles, model.positions, at_rest);
  model.lagged_loads.push_back(
      {std::make_unique<DeadLoad>(load.name, std::move(at_rest), true),
       [size, triangles](const Vector& positions, const Vector& /*velocities*/, Vector& forces) {
         add_pressure_forces(size, triangles, positions, forces);
       }});
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
      add_pressure(load, *pressure, shape, model);
    } else if (const auto* surface = std::get_if<scene::SurfaceLoad>(&load.kind)) {
      add_dead_load(load.name, surface_forces(load, *surface, shape, size));
    } else if (const auto* moment = std::get_if<scene::EndMoment>(&load.kind)) {
      model.end_moments.push_back(end_moment(scene, load, *moment, shape, model.positions));
    } else {
      const auto& air = std::get<scene::Wind>(load.kind);
      const Wind wind{air.velocity, air.air_density, air.drag};
      model.lagged_loads.push_back({std::make_unique<DeadLoad>(load.name, Vector::Zero(size), true),
                                    [wind, triangles = pressed_triangles(shape, scene::Surface::top)](
                                        const Vector& positions, const Vector& velocities, Vector& forces) {
                                      add_wind(wind, triangles, 0, positions, velocities, forces);
                                    }});
    }
  }
}

}  // namespace taut
