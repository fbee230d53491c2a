#include "support/shells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "core/assembly.h"
#include "energies/dead_load.h"
#include "energies/prism_mass.h"
#include "linalg/cholesky.h"
#include "solvers/newton.h"
#include "support/meshes.h"
#include "support/random_values.h"

namespace taut {

ShellCase::ShellCase(TriangleMesh surface, double thickness, const std::vector<double>& fractions)
    : mesh(std::move(surface)), layered(make_layered(mesh, std::vector{thickness}, fractions, "shell")) {
  fixed.assign(3 * layered.nodes.size(), false);
  forces = Vector::Zero(3 * static_cast<Index>(layered.nodes.size()));
}

ShellCase::ShellCase(TriangleMesh surface, const std::vector<Vector3>& normals, double thickness)
    : mesh(std::move(surface)) {
  std::vector<Vector3> bottom = mesh.vertices, top = mesh.vertices;
  for (std::size_t v = 0; v < normals.size(); ++v) {
    bottom[v] -= 0.5 * thickness * normals[v];
    top[v] += 0.5 * thickness * normals[v];
  }
  layered = make_layered(mesh, bottom, top, {1.0}, "shell");
  fixed.assign(3 * layered.nodes.size(), false);
  forces = Vector::Zero(3 * static_cast<Index>(layered.nodes.size()));
}

Vector ShellCase::rest() const { return flatten(layered.nodes); }

void ShellCase::set_material(int layer, const SolidMaterial& material, const PrismShellOptions& options,
                             const Vector3& fibres) {
  const auto triangles = static_cast<std::ptrdiff_t>(mesh.triangles.size());
  std::vector<Prism> prisms = layered.prisms;
  if (layer >= 0) {
    const auto first = layered.prisms.begin() + layer * triangles;
    prisms.assign(first, first + triangles);
  }
  energies.push_back(
      std::make_shared<PrismShell>("shell", rest_prisms(prisms, layered.nodes, fibres), material, options));
}

void ShellCase::fix(int vertex, int axis) {
  for (int level = 0; level <= layered.layers; ++level) fixed[3 * layered.node(vertex, level) + axis] = true;
}

void ShellCase::add_force(int vertex, const Vector3& force) {
  forces.segment<3>(3 * layered.node(vertex, 0)) += 0.5 * force;
  forces.segment<3>(3 * layered.node(vertex, layered.layers)) += 0.5 * force;
}

void ShellCase::add_surface_load(const Vector3& per_area) {
  for (const Triangle& t : mesh.triangles) {
    const Vector3 a = mesh.vertices[t[1]] - mesh.vertices[t[0]], b = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    for (int vertex : t) add_force(vertex, per_area * (a.cross(b).norm() / 6));
  }
}

std::vector<int> ShellCase::fixed_variables() const {
  std::vector<int> variables;
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (fixed[i]) variables.push_back(static_cast<int>(i));
  }
  return variables;
}

namespace {

/// The exact Hessian at rest, factorised.
struct RestStiffness {
  Assembly assembly;
  std::unique_ptr<Cholesky> cholesky;

  RestStiffness(const ShellCase& shell, const std::vector<int>& fixed)
      : assembly(shell.forces.size(), terms(shell), fixed, 1) {
    assembly.set_order(fill_reducing_order(assembly.graph()));
    assembly.hessian(shell.rest(), Curvature::exact);
    cholesky = std::make_unique<Cholesky>(assembly.matrix(), 1);
    if (!cholesky->factorize(assembly.matrix())) throw std::runtime_error("the stiffness at rest is not definite");
  }
  static std::vector<const Energy*> terms(const ShellCase& shell) {
    std::vector<const Energy*> all;
    for (const auto& energy : shell.energies) all.push_back(energy.get());
    return all;
  }
  Vector solve(Vector loads, const std::vector<int>& fixed) {
    for (int variable : fixed) loads[variable] = 0;
    Vector ordered, u(loads.size());
    assembly.to_ordered(loads, ordered);
    cholesky->solve(ordered, ordered);
    assembly.from_ordered(ordered, u);
    return u;
  }
};

}  // namespace

Vector ShellCase::linear_displacement() const {
  return RestStiffness(*this, fixed_variables()).solve(forces, fixed_variables());
}

double ShellCase::lowest_frequency(double density) const {
  const Inertia inertia = consistent_prism_inertia("inertia", layered.prisms, layered.nodes, density);
  RestStiffness stiffness(*this, fixed_variables());
  Vector mode = RandomValues(1).vector(forces.size());
  double square = 0;
  for (int i = 0; i < 200; ++i) {
    Vector momentum = Vector::Zero(mode.size());
    inertia.add_product(mode, momentum);
    const Vector next = stiffness.solve(momentum, fixed_variables());
    const double last = square;
    square = 1 / std::sqrt(2 * inertia.kinetic_energy(next));  // the mode before has norm 1
    mode = next * square;
    if (std::abs(square - last) <= 1e-12 * square) break;
  }
  return std::sqrt(square);
}

Vector3 ShellCase::mean(int vertex, const Vector& values) const {
  Vector3 sum = Vector3::Zero();
  for (int level = 0; level <= layered.layers; ++level) sum += values.segment<3>(3 * layered.node(vertex, level));
  return sum / (layered.layers + 1);
}

Status ShellCase::minimise(Vector& x, double tolerance, const std::vector<const Energy*>& more) const {
  const DeadLoad load("load", forces);
  std::vector<const Energy*> terms = more;
  for (const auto& energy : energies) terms.push_back(energy.get());
  if (load.stencils().count() > 0) terms.push_back(&load);
  Assembly assembly(forces.size(), terms, fixed_variables(), 1);
  assembly.set_order(fill_reducing_order(assembly.graph()));
  assembly.hessian(x, Curvature::positive_semidefinite);
  Cholesky cholesky(assembly.matrix(), 1);
  SubstitutedSystem system(assembly, cholesky);
  const std::vector<int> held = fixed_variables();
  NewtonState state;
  state.x = x;
  Counts counts;
  Timings timings;
  const Status status =
      Newton(assembly, system, held, 3, {})
          .minimise(
              state, [&](const NewtonState& s) { return s.nodal_norm <= tolerance; }, {}, counts, timings);
  x = state.x;
  return status;
}

void expect_ratio(const std::string& what, double ours, double reference, double tolerance) {
  std::printf("%-66s %12.6g %12.6g %9.5f\n", what.c_str(), ours, reference, ours / reference);
  EXPECT_NEAR(ours / reference, 1.0, tolerance) << what;
}

std::array<Vector3, 6> random_prism(unsigned seed, double curvature) {
  RandomValues random(seed);
  std::array<Vector3, 6> points;
  const std::array<Vector3, 3> mid{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0.2, 0.9, 0)};
  const Matrix3 turn = random.rotation();
  for (int j = 0; j < 3; ++j) {
    const Vector3 x = mid[j] + 0.1 * random.vector(3);
    const Vector3 n = 0.2 * (Vector3::UnitZ() + curvature * random.vector(3));
    points[2 * j] = turn * (x - n);
    points[2 * j + 1] = turn * (x + n);
  }
  return points;
}

}  // namespace taut
