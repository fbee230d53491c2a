#include "problems/build.h"

#include <algorithm>

#include "energies/hinge_bending.h"
#include "energies/linear_tetrahedra.h"
#include "energies/membrane.h"
#include "problems/body_shape.h"
#include "problems/build_parts.h"
#include "solvers/alternating.h"
#include "solvers/augmented_lagrangian.h"
#include "solvers/ipopt.h"
#include "solvers/nlopt.h"
#include "solvers/penalised_pins.h"

namespace taut {
namespace {

void add_mesh(const scene::Body& body, const BodyShape& shape, Model& model) {
  const std::vector<Vector3>& points = shape.layered ? shape.layered->nodes : shape.mesh.vertices;
  model.bodies.push_back({body.name, shape.first_node, shape.nodes(), shape.first_triangle,
                          static_cast<int>(shape.rest.size()), shape.levels()});
  for (const RestTriangle& rest : shape.rest) model.triangles.push_back(rest.vertices);
  for (std::size_t v = 0; v < points.size(); ++v) {
    const Index first = 3 * (shape.first_node + static_cast<Index>(v));
    model.positions.segment<3>(first) = points[v];
    model.velocities.segment<3>(first) = body.initial_velocity;
  }
}

void add_elastic(std::unique_ptr<Energy> energy, double beta, Model& model) {
  if (beta > 0)
    model.stiffness_damping.push_back(
        {std::make_unique<StiffnessDamping>("damping of " + energy->name(), *energy), beta});
  model.elastic.push_back(std::move(energy));
}

}  // namespace

void add_material(const Scene& scene, const scene::Body& body, const BodyShape& shape, Model& model) {
  if (body.shell) {
    for (auto& energy : add_shell(scene, body, shape, model))
      add_elastic(std::move(energy), body.damping.stiffness, model);
    return;
  }
  if (body.solid) {
    const TetrahedronMesh mesh{shape.mesh.vertices, shape.tetrahedra};
    model.inertia.push_back(std::make_unique<Inertia>(
        tetrahedron_inertia("inertia of " + body.name, mesh, body.density, body.mass == scene::Mass::lumped)));
    model.mass_damping.push_back(body.damping.mass);
    model.elastic.push_back(std::make_unique<LinearTetrahedra>("solid of " + body.name, mesh, body.solid->young_modulus,
                                                               body.solid->poisson_ratio));
    return;
  }
  const double surface_density = body.density * body.thickness;
  model.inertia.push_back(std::make_unique<Inertia>(
      body.mass == scene::Mass::lumped
          ? Inertia::lumped("inertia of " + body.name, shape.rest, surface_density, model.positions.size() / 3)
          : Inertia::consistent("inertia of " + body.name, shape.rest, surface_density)));
  model.mass_damping.push_back(body.damping.mass);
  if (body.membrane) {
    const Lame lame = Lame::plane_stress(body.membrane->young_modulus, body.membrane->poisson_ratio);
    add_elastic(
        std::make_unique<Membrane>("membrane of " + body.name, shape.rest, body.membrane->law, lame, body.thickness),
        body.damping.stiffness, model);
  }
  if (body.cover && body.cover->foundation > 0) add_elastic(foundation_of(body, shape), body.damping.stiffness, model);
  if (body.bending) {
    const double stiffness = body.bending->stiffness;
    const auto& triangles = shape.mesh.triangles;
    std::vector<Hinge> hinges = shape.rest_uv.empty()
                                    ? make_hinges(triangles, shape.rest_positions, stiffness, false, shape.first_node)
                                    : make_hinges(triangles, shape.rest_uv, stiffness, shape.first_node);
    add_elastic(std::make_unique<HingeBending>("bending of " + body.name, std::move(hinges)), body.damping.stiffness,
                model);
  }
}

namespace {

AugmentedLagrangianOptions augmented_lagrangian_options(const Scene& scene, int threads) {
  AugmentedLagrangianOptions options;
  options.tolerances = scene.solver.tolerance;
  // Measured: with obstacles the path takes 2 to 7 times the linear solves of the loop of multiplier updates; with
  // covers, whose wrinkles make the curvature indefinite, up to 14 times, most of them until it gives up.
  const bool obstacles =
      std::any_of(scene.constraints.begin(), scene.constraints.end(), [](const scene::Constraint& constraint) {
        return std::holds_alternative<scene::HalfSpace>(constraint.kind) ||
               std::holds_alternative<scene::Sphere>(constraint.kind);
      });
  const bool covers = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                  [](const scene::Body& body) { return body.cover.has_value(); });
  // Equalities have no interior.
  const bool modal = is_modal(scene);
  options.central_path.enabled = scene.solver.central_path && !obstacles && !covers && !modal;
  options.penalty = scene.solver.penalty;
  options.penalty_growth = scene.solver.penalty_growth;
  options.fixed_penalty = scene.solver.fixed_penalty;
  options.warm_multipliers = scene.solver.warm_multipliers;
  options.conjugate_gradients = scene.solver.conjugate_gradients;
  options.equalities = scene.solver.equalities;
  options.null_space = scene.solver.method == scene::SolverMethod::null_space;
  options.inner_tolerance_factor = scene.solver.inner_tolerance_factor;
  options.screening = scene.solver.screening;
  if (scene.solver.longest_step > 0)
    options.newton.longest_step = options.central_path.longest_step = scene.solver.longest_step;
  options.newton_finish = scene.solver.newton_finish;
  options.max_outer = scene.solver.max_outer;
  options.max_newton = scene.solver.max_newton;
  options.threads = threads;
  return options;
}

std::unique_ptr<Solver> build_augmented_lagrangian(const Scene& scene, int threads) {
  const AugmentedLagrangianOptions options = augmented_lagrangian_options(scene, threads);
  auto solver = std::make_unique<AugmentedLagrangian>(options);
  if (!scene.solver.penalised_pins) return solver;
  return std::make_unique<PenalisedPins>(std::move(solver), options.tolerances);
}

std::unique_ptr<Solver> build_alternating(const Scene& scene, int threads) {
  const bool covers = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                  [](const scene::Body& body) { return body.cover.has_value(); });
  if (!covers) {
    throw InputError(scene.source, "/solver/method",
                     "found \"alternating\", allowed: another one (no body has a cover to take its turn with)");
  }
  return std::make_unique<Alternating>(augmented_lagrangian_options(scene, threads));
}

std::unique_ptr<Solver> build_ipopt(const Scene& scene) {
#ifdef TAUT_WITH_IPOPT
  IpoptOptions options;
  options.tolerances = scene.solver.tolerance;
  options.max_iterations = scene.solver.ipopt.max_iterations;
  options.warm_start = scene.solver.ipopt.warm_start;
  return std::make_unique<Ipopt>(options);
#else
  throw InputError(scene.source, "/solver/method",
                   "found \"ipopt\", allowed: another one (this program was built without Ipopt)");
#endif
}

std::unique_ptr<Solver> build_nlopt(const Scene& scene) {
  NloptOptions options;
  options.tolerances = scene.solver.tolerance;
  options.algorithm = scene.solver.nlopt.algorithm;
  options.max_evaluations = scene.solver.nlopt.max_evaluations;
  return std::make_unique<Nlopt>(options);
}

/// The triangles of a mesh that touch any of these vertices, ascending both.
std::vector<int> triangles_at(const std::vector<int>& vertices, const TriangleMesh& mesh) {
  std::vector<int> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto selected = [&](int v) { return std::binary_search(vertices.begin(), vertices.end(), v); };
    if (std::any_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), selected))
      triangles.push_back(static_cast<int>(t));
  }
  return triangles;
}

/// Bottom and top for the mean over `both`; all nodes for a force on it. Triangles for what shells have there. None for
/// energies and frequencies.
std::vector<int> probed_nodes(const Scene& scene, const std::vector<BodyShape>& shapes, const scene::Probe& probe) {
  std::vector<int> nodes;
  using scene::Quantity;
  if (probe.quantity == Quantity::energy || probe.quantity == Quantity::frequency) return nodes;
  const BodyShape& shape = shapes[static_cast<std::size_t>(probe.body)];
  const std::string pointer = "/output/probes/" + probe.name + "/select";
  const std::vector<int> vertices = selected_vertices(scene, shape, probe.select, pointer);
  if (probe.quantity == Quantity::resultant || probe.quantity == Quantity::stress ||
      probe.quantity == Quantity::stretch)
    return triangles_at(vertices, shape.mesh);
  for (const int vertex : vertices) {
    const std::vector<int> at = probe.quantity == Quantity::force ? shape.nodes_at(vertex, probe.surface)
                                                                  : shape.mean_nodes(vertex, probe.surface);
    nodes.insert(nodes.end(), at.begin(), at.end());
  }
  return nodes;
}

/// Only the meshes tell how large the problem is.
void refuse_more_than_nlopt_takes(const Scene& scene, const Model& model) {
  if (scene.solver.method != scene::SolverMethod::nlopt) return;
  const NloptAlgorithm algorithm = scene.solver.nlopt.algorithm;
  const Index unknowns = model.positions.size() - static_cast<Index>(model.pins.size());
  if (unknowns <= largest_nlopt_problem(algorithm)) return;
  throw InputError(scene.source, "/solver/method",
                   "found \"nlopt\" for " + std::to_string(unknowns) + " unknowns, allowed: at most " +
                       std::to_string(largest_nlopt_problem(algorithm)) + " with " + std::string(to_string(algorithm)) +
                       ", beyond which a step takes minutes");
}

}  // namespace

std::unique_ptr<Model> build_model(const Scene& scene) {
  std::vector<BodyShape> shapes;
  shapes.reserve(scene.bodies.size());
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    shapes.push_back(make_body_shape(scene, k, k > 0 ? &shapes[k - 1] : nullptr));

  auto model = std::make_unique<Model>();
  model->name = scene.name;
  const Index vertices = shapes.empty() ? 0 : shapes.back().first_node + shapes.back().nodes();
  model->positions.resize(3 * vertices);
  model->velocities.resize(3 * vertices);
  if (is_modal(scene)) {
    add_mesh(scene.bodies[0], shapes[0], *model);
    reduce_to_modes(scene, shapes[0], *model);
    refuse_more_than_nlopt_takes(scene, *model);
    for (const scene::Probe& probe : scene.output.probes) model->probed.push_back(probed_nodes(scene, shapes, probe));
    return model;
  }
  for (std::size_t k = 0; k < shapes.size(); ++k) add_mesh(scene.bodies[k], shapes[k], *model);
  for (std::size_t k = 0; k < shapes.size(); ++k) add_material(scene, scene.bodies[k], shapes[k], *model);
  add_constraints(scene, shapes, *model);
  add_couplings(scene, shapes, *model);
  refuse_more_than_nlopt_takes(scene, *model);
  add_loads(scene, shapes, *model);
  for (const scene::Probe& probe : scene.output.probes) model->probed.push_back(probed_nodes(scene, shapes, probe));
  return model;
}

TimeOptions time_options(const Scene& scene) {
  TimeOptions options;
  switch (scene.time.integrator) {
    case scene::Integrator::implicit_euler:
      options.integrator = Integrator::implicit_euler;
      break;
    case scene::Integrator::bdf2:
      options.integrator = Integrator::bdf2;
      break;
    case scene::Integrator::generalised_alpha:
      options.integrator = Integrator::generalised_alpha;
      break;
    case scene::Integrator::newmark:
      options.integrator = Integrator::newmark;
      break;
    case scene::Integrator::quasi_static:
      options.integrator = Integrator::quasi_static;
      break;
  }
  options.step = scene.time.step;
  options.steps = scene.time.steps;
  options.spectral_radius = scene.time.spectral_radius;
  options.beta = scene.time.beta;
  options.gamma = scene.time.gamma;
  return options;
}

std::unique_ptr<Solver> build_solver(const Scene& scene, int threads) {
  switch (scene.solver.method) {
    case scene::SolverMethod::augmented_lagrangian:
    case scene::SolverMethod::null_space:
      return build_augmented_lagrangian(scene, threads);
    case scene::SolverMethod::alternating:
      return build_alternating(scene, threads);
    case scene::SolverMethod::ipopt:
      return build_ipopt(scene);
    case scene::SolverMethod::nlopt:
      return build_nlopt(scene);
  }
  throw std::logic_error("build_solver: not a SolverMethod");
}

}  // namespace taut
