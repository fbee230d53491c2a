#pragma once

#include <cmath>
#include <memory>

#include "constraints/strain_limit.h"
#include "dynamics/stepper.h"
#include "energies/membrane.h"
#include "geometry/grid.h"
#include "solvers/augmented_lagrangian.h"

namespace taut {

/// A body of these triangles without elasticity; rest shape and start are the vertices. Density 1 kg/m^2.
inline Model model_of(const TriangleMesh& mesh, bool consistent = false) {
  Model model;
  model.name = "small";
  model.triangles = mesh.triangles;
  model.bodies = {{"patch", 0, static_cast<int>(mesh.vertices.size()), 0, static_cast<int>(mesh.triangles.size())}};
  const Index vertices = static_cast<Index>(mesh.vertices.size());
  model.positions.resize(3 * vertices);
  for (Index v = 0; v < vertices; ++v) model.positions.segment<3>(3 * v) = mesh.vertices[v];
  model.velocities = Vector::Zero(3 * vertices);
  const auto rest = rest_triangles(mesh.triangles, mesh.vertices);
  model.inertia.push_back(std::make_unique<Inertia>(consistent ? Inertia::consistent("inertia", rest, 1.0)
                                                               : Inertia::lumped("inertia", rest, 1.0, vertices)));
  model.mass_damping = {0.0};
  return model;
}

inline void add_membrane(const TriangleMesh& mesh, Model& model, double young_modulus = 2.0) {
  model.elastic.push_back(std::make_unique<Membrane>("membrane", rest_triangles(mesh.triangles, mesh.vertices),
                                                     MembraneLaw::stvk, Lame::plane_stress(young_modulus, 0.3), 1.0));
}

inline void add_gravity(const Vector3& gravity, Model& model) {
  Vector forces = Vector::Zero(model.positions.size());
  model.inertia[0]->add_product(gravity.replicate(model.positions.size() / 3, 1), forces);
  model.dead_loads.push_back(std::make_unique<DeadLoad>("gravity", forces));
}

inline void add_limit(const TriangleMesh& mesh, double min, double max, Model& model) {
  StrainLimitTriangles limit;
  limit.constraint = "limit";
  limit.body = "patch";
  limit.triangles = rest_triangles(mesh.triangles, mesh.vertices);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) limit.ids.push_back(static_cast<int>(t));
  limit.min = min;
  limit.max = max;
  model.constraints.push_back(std::make_unique<MatrixStrainLimit>(std::move(limit)));
}

inline void pin(
    int vertex, Model& model,
    const std::function<Vector3(double)>& shift = [](double) { return Vector3(Vector3::Zero()); }) {
  const Vector3 start = model.positions.segment<3>(3 * vertex);
  for (int axis = 0; axis < 3; ++axis) {
    model.pins.push_back({3 * vertex + axis, [=](double time) { return start[axis] + shift(time)[axis]; }});
  }
}

inline TriangleMesh patch_mesh() { return make_grid(1, 1, 2, 2, Diagonals::alternating); }

/// A unit square of 2 x 2 cells held by its edge y = 0, stretched by a quarter, sheared and bulged: it vibrates with
/// periods of a few seconds.
inline Model vibrating_patch(bool consistent = false) {
  const TriangleMesh mesh = patch_mesh();
  Model model = model_of(mesh, consistent);
  add_membrane(mesh, model);
  for (int v = 0; v < 3; ++v) pin(v, model);
  for (Index v = 3; v < 9; ++v) {
    auto x = model.positions.segment<3>(3 * v);
    x += Vector3(0.1 * x.y() * x.y(), 0.25 * x.y(), 0.1 * x.y() * (1 - 0.5 * x.x()));
    model.velocities.segment<3>(3 * v) = Vector3(0.0, -0.1, 0.2) * x.y();
  }
  return model;
}

/// A triangle whose edge on the x axis is held and which can neither stretch nor shrink: a rigid pendulum of length 1
/// m, at `angle` from the vertical.
inline Model pendulum(double angle, double gravity = 9.81) {
  TriangleMesh mesh;
  mesh.vertices = {{-0.5, 0, 0}, {0.5, 0, 0}, {0, std::sin(angle), -std::cos(angle)}};
  mesh.triangles = {{0, 1, 2}};
  Model model = model_of(mesh);
  add_gravity({0, 0, -gravity}, model);
  pin(0, model);
  pin(1, model);
  add_limit(mesh, 1, 1, model);
  return model;
}

inline AugmentedLagrangian tight_solver(double tolerance = 1e-11) {
  AugmentedLagrangianOptions options;
  options.tolerances = {tolerance, tolerance, tolerance};
  return AugmentedLagrangian(options);
}

/// Takes `steps` steps; throws where one is not solved.
inline void advance(Stepper& stepper, Solver& solver, int steps) {
  for (int k = 0; k < steps; ++k) {
    const Result result = solver.solve(stepper.prepare(), stepper.state().warm, Budget{});
    if (result.status != Status::solved) {
      throw std::runtime_error("step " + std::to_string(stepper.state().step + 1) + ": " +
                               std::string(to_string(result.status)) + ", " + result.message);
    }
    stepper.accept(result);
  }
}

}  // namespace taut
