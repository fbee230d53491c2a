#include <algorithm>
#include <cmath>
#include <map>

#include "dynamics/modal/modal_basis.h"
#include "dynamics/modal/modal_energies.h"
#include "dynamics/modal/warped_position.h"
#include "problems/build.h"
#include "problems/build_parts.h"
#include "problems/modal_file.h"

namespace taut {
namespace {

const scene::Body& only_body(const Scene& scene) { return scene.bodies.front(); }

std::string pointer_to(const Scene& scene) { return "/bodies/" + only_body(scene).name + "/modal"; }

/// The body as it is without modes, its clamp as pins.
Model full_model(const Scene& scene, const BodyShape& shape, const Model& reduced) {
  const scene::Body& body = only_body(scene);
  Model full;
  full.name = scene.name;
  full.bodies = reduced.bodies;
  full.triangles = reduced.triangles;
  full.positions = reduced.positions;
  full.velocities = reduced.velocities;
  add_material(scene, body, shape, full);
  if (!body.modal->clamp) return full;
  for (const int vertex : selected_vertices(scene, shape, *body.modal->clamp, pointer_to(scene) + "/clamp")) {
    for (const int node : shape.nodes_at(vertex, scene::Surface::both)) {
      for (int axis = 0; axis < 3; ++axis) {
        const double value = full.positions[3 * node + axis];
        full.pins.push_back({3 * node + axis, [value](double) { return value; }});
      }
    }
  }
  return full;
}

SparseMatrix curl_of(const BodyShape& shape) {
  if (shape.layered) return prism_curl(shape.layered->nodes, shape.layered->prisms);
  if (!shape.tetrahedra.empty()) return tetrahedron_curl(shape.mesh.vertices, shape.tetrahedra);
  return surface_curl(shape.mesh.vertices, shape.mesh.triangles);
}

ModalBasis basis_of(const Scene& scene, const BodyShape& shape, const Model& full) {
  const scene::Modal& modal = *only_body(scene).modal;
  const std::string mesh_hash = hash_of_mesh(full.positions, full.triangles, shape.tetrahedra),
                    body_hash = hash_of_body(scene);
  if (!modal.basis.empty()) {
    try {
      ModalBasis basis = read_basis(modal.basis, mesh_hash, body_hash);
      if (basis.modes() < modal.modes) {
        throw FileError(modal.basis, "holds " + std::to_string(basis.modes()) + " modes, fewer than the " +
                                         std::to_string(modal.modes) + " asked for");
      }
      return basis.truncated(modal.modes);
    } catch (const FileError& error) {
      throw InputError(scene.source, pointer_to(scene) + "/basis", error.what());
    }
  }
  try {
    ModalBasis basis = modal_basis(full, curl_of(shape), modal.modes, 1);
    basis.mesh_hash = mesh_hash;
    basis.body_hash = body_hash;
    return basis;
  } catch (const std::exception& error) {
    throw InputError(scene.source, pointer_to(scene) + "/modes", error.what());
  }
}

void add_unit_mass(const scene::Body& body, Index modes, Model& model) {
  auto inertia = std::make_unique<Inertia>("inertia of " + body.name, 1, 1);
  const double one = 1;
  for (int k = 0; k < static_cast<int>(modes); ++k) inertia->add_element({&k, 1}, {&one, 1});
  model.inertia.push_back(std::move(inertia));
  model.mass_damping.push_back(body.damping.mass);
}

/// 2 zeta omega + beta omega^2 of each mode.
void add_damping(const scene::Body& body, const ModalBasis& basis, Model& model) {
  if (body.damping.stiffness == 0 && body.modal->damping_ratio == 0) return;
  const Vector rates = basis.eigenvalues.cwiseMax(0).cwiseSqrt();
  const Vector damping = 2 * body.modal->damping_ratio * rates + body.damping.stiffness * basis.eigenvalues;
  model.damped.push_back(std::make_unique<ModalStiffness>("damped modes of " + body.name, damping));
  model.stiffness_damping.push_back(
      {std::make_unique<StiffnessDamping>("damping of " + body.name, *model.damped.back()), 1.0});
}

void add_warped_loads(const Scene& scene, const Model& full, Model& model) {
  if (!full.pressures.empty() || !full.lagged_loads.empty() || !full.end_moments.empty()) {
    throw InputError(scene.source, "/loads",
                     "found a load that follows the body, allowed: gravity and dead loads of a modal body");
  }
  for (const auto& load : full.dead_loads) {
    model.warped_loads.push_back(std::make_unique<WarpedLoad>(load->name(), *model.modal, load->forces()));
    if (only_body(scene).modal->rotation != scene::WarpRotation::predictor) continue;
    model.freezers.push_back([load = model.warped_loads.back().get()](const Vector& q) { load->freeze(q); });
  }
}

/// The coordinates that a pin holds, which the modes have to be able to move.
std::vector<WarpedPosition::Held> held_by(const Scene& scene, const scene::Constraint& constraint,
                                          const scene::Pin& pin, const BodyShape& shape, const ModalBasis& basis) {
  const std::string pointer = "/constraints/" + constraint.name + "/select";
  const bool axes[3] = {pin.x, pin.y, pin.z};
  std::vector<WarpedPosition::Held> held;
  for (const int vertex : selected_vertices(scene, shape, constraint.select, pointer)) {
    for (const int node : shape.nodes_at(vertex, constraint.surface)) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!axes[axis]) continue;
        if (basis.shapes.row(3 * node + axis).isZero(0)) {
          throw InputError(scene.source, pointer,
                           "found vertex " + std::to_string(vertex) + ", which the modes clamp, allowed: others");
        }
        held.push_back({node, axis});
      }
    }
  }
  return held;
}

void add_warped_positions(const Scene& scene, const BodyShape& shape, Model& model) {
  const double size = scene_size(model.modal->rest);
  Index rows = 0;
  for (const scene::Constraint& constraint : scene.constraints) {
    const auto* pin = std::get_if<scene::Pin>(&constraint.kind);
    if (!pin) {
      throw InputError(scene.source, "/constraints/" + constraint.name + "/type",
                       "found a constraint that is not a pin, allowed: pins of a modal body");
    }
    const auto held = held_by(scene, constraint, *pin, shape, *model.modal);
    rows += static_cast<Index>(held.size());
    auto position =
        std::make_unique<WarpedPosition>(constraint.name, shape.name, shape.levels(), model.modal, held, size);
    const auto place = [at = position.get(), pin = *pin, held, basis = model.modal](double time) {
      Vector targets(static_cast<Index>(held.size()));
      for (std::size_t k = 0; k < held.size(); ++k) {
        const Vector3 start = basis->rest.segment<3>(3 * held[k].node);
        targets[static_cast<Index>(k)] = pin.motion.position(start, time)[held[k].axis];
      }
      at->set_targets(std::move(targets));
    };
    place(0);
    if (!pin->motion.at_rest()) model.movers.emplace_back(place);
    if (only_body(scene).modal->rotation == scene::WarpRotation::predictor) {
      model.freezers.push_back([at = position.get()](const Vector& q) { at->freeze(q); });
    }
    model.constraints.push_back(std::move(position));
  }
  if (rows > model.modal->modes()) {
    throw InputError(scene.source, "/constraints",
                     "found " + std::to_string(rows) +
                         " coordinates held by pins, allowed: at most one for each of the " +
                         std::to_string(model.modal->modes()) + " modes");
  }
}

}  // namespace

bool is_modal(const Scene& scene) { return !scene.bodies.empty() && scene.bodies.front().modal.has_value(); }

ModalBasis build_modal_basis(const Scene& scene) {
  if (!is_modal(scene)) throw InputError(scene.source, "/bodies", "found no modal body, allowed: one");
  return *build_model(scene)->modal;
}

void reduce_to_modes(const Scene& scene, const BodyShape& shape, Model& model) {
  const scene::Body& body = only_body(scene);
  Model full = full_model(scene, shape, model);
  std::vector<BodyShape> shapes{shape};
  add_loads(scene, shapes, full);
  ModalBasis basis = basis_of(scene, shape, full);
  basis.warped = body.modal->rotation != scene::WarpRotation::none;
  model.modal = std::make_shared<ModalBasis>(std::move(basis));
  const Index modes = model.modal->modes();
  Vector momentum = Vector::Zero(full.velocities.size());
  for (const auto& inertia : full.inertia) inertia->add_product(full.velocities, momentum);
  model.velocities = model.modal->shapes.transpose() * momentum;
  model.positions = Vector::Zero(modes);
  model.surfaces = shape.rest;
  add_unit_mass(body, modes, model);
  model.elastic.push_back(std::make_unique<ModalStiffness>("elastic modes of " + body.name, model.modal->eigenvalues));
  add_damping(body, *model.modal, model);
  add_warped_loads(scene, full, model);
  add_warped_positions(scene, shape, model);
}

}  // namespace taut
