#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "constraints/coupling.h"
#include "energies/foundation.h"
#include "geometry/measures.h"
#include "problems/build_parts.h"
#include "problems/cover_shape.h"

namespace taut {
namespace {

std::vector<double> vertex_areas(const BodyShape& shape) {
  std::vector<double> areas(shape.mesh.vertices.size(), 0.0);
  for (const RestTriangle& triangle : shape.rest) {
    for (const int node : triangle.vertices)
      areas[static_cast<std::size_t>(node - shape.first_node)] += triangle.area / 3;
  }
  return areas;
}

void note_far_points(const scene::Body& body, const BodyShape& shape, double surface_size, Model& model) {
  const double farthest = body.cover->farthest.value_or(1e-3 * surface_size);
  const auto& anchors = shape.prolongation->anchors;
  const auto worst = std::max_element(anchors.begin(), anchors.end(),
                                      [](const Anchor& a, const Anchor& b) { return a.distance < b.distance; });
  const auto far =
      std::count_if(anchors.begin(), anchors.end(), [&](const Anchor& a) { return a.distance > farthest; });
  if (far == 0) return;
  model.notes.push_back(fmt::format(
      "{}: {} of its {} vertices are farther than {:.3g} m from the surface they follow, vertex {} as far as {:.3g} m",
      body.name, far, anchors.size(), farthest, worst - anchors.begin(), worst->distance));
}

/// E/(1 - nu^2) of an isotropic solid: stretched along axis 1, held along axis 2, free through the thickness; Pa.
double plane_strain_modulus(const SolidMaterial& material) {
  const Elasticity& d = material.elasticity;
  return d(0, 0) - d(0, 2) * d(0, 2) / d(2, 2);
}

/// The wavelength at which a film wrinkles on what is below it, m: 2 pi (B/K)^(1/4) on a Winkler foundation, else
/// 2 pi (4 B/E')^(1/3) on the layer of the shell that it is on, taken as deep and half a space [Allen 1969, (8.17)].
std::optional<double> wavelength(const scene::Body& shell, const scene::Body& cover) {
  if (!cover.bending) return {};
  const double stiffness = cover.bending->stiffness, pi = std::numbers::pi;
  if (cover.cover->foundation > 0) return 2 * pi * std::pow(stiffness / cover.cover->foundation, 0.25);
  if (!shell.shell || cover.cover->surface == scene::Surface::mid) return {};
  const std::vector<scene::Layer>& layers = shell.shell->layers;
  const scene::Layer& layer = cover.cover->surface == scene::Surface::top ? layers.back() : layers.front();
  return 2 * pi * std::cbrt(4 * stiffness / plane_strain_modulus(layer.material));
}

void note_wavelength(const scene::Body& shell, const scene::Body& cover, const TriangleMesh& surface, Model& model) {
  const std::optional<double> length = wavelength(shell, cover);
  const double edge = mean_edge_length(surface);
  if (!length || *length <= 2 * edge) return;
  model.notes.push_back(fmt::format(
      "{}: its wrinkles would be about {:.3g} m long, but it has none above {:.3g} m, twice the edge of the shell's "
      "mesh; use a shell with edges of at least {:.3g} m, or of at most {:.3g} m to carry such wrinkles itself",
      cover.name, *length, 2 * edge, 0.5 * *length, *length / 8));
}

/// Coupling equations that pins decide alone: how many, and whether they contradict each other. Each axis has its own.
void note_redundance(const LinearEqualities& equal, Model& model) {
  Vector is_free = Vector::Ones(equal.rows.cols()), held_start = Vector::Zero(equal.rows.cols()), held_end = held_start;
  for (const PinnedVariable& pin : model.pins) {
    is_free[pin.variable] = 0;
    held_start[pin.variable] = pin.value(0);
    held_end[pin.variable] = pin.value(1);
  }
  const Vector start = equal.rows * held_start - equal.values, end = equal.rows * held_end - equal.values;
  const SparseMatrix gram = equal.rows * is_free.asDiagonal() * SparseMatrix(equal.rows.transpose());
  Index dependent = 0;
  double worst = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto own = Eigen::seqN(axis, equal.rows.rows() / 3, 3);
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(Matrix(gram)(own, own));
    for (Index k = 0; k < eigen.eigenvalues().size(); ++k) {
      if (eigen.eigenvalues()[k] > 1e-12 * eigen.eigenvalues().maxCoeff()) continue;
      ++dependent;
      for (const Vector* held : {&start, &end})
        worst = std::max(worst, std::abs(eigen.eigenvectors().col(k).dot(Vector((*held)(own)))));
    }
  }
  if (dependent == 0) return;
  std::string note = fmt::format("{}: pins decide {} of its {} equations", equal.name, dependent, equal.rows.rows());
  if (worst > 1e-9 * equal.violation_scale)
    note += fmt::format(" and contradict them by {:.3g} m at time 0 or 1: no step can satisfy both", worst);
  model.notes.push_back(note);
}

bool has_pins(const BodyShape& shape, const Model& model) {
  return std::any_of(model.pins.begin(), model.pins.end(), [&](const PinnedVariable& pin) {
    const int node = pin.variable / 3;
    return node >= shape.first_node && node < shape.first_node + shape.nodes();
  });
}

}  // namespace

std::unique_ptr<Energy> foundation_of(const scene::Body& body, const BodyShape& shape) {
  const std::vector<double> areas = vertex_areas(shape);
  std::vector<WinklerFoundation::Spring> springs;
  for (std::size_t i = 0; i < areas.size(); ++i) {
    WinklerFoundation::Spring spring{shape.first_node + static_cast<int>(i), {}, {}, areas[i]};
    const Anchor& anchor = shape.prolongation->anchors[i];
    for (int k = 0; k < 3; ++k) {
      const std::vector<int>& nodes = shape.carriers[static_cast<std::size_t>(shape.carrying_triangle(anchor)[k])];
      for (const int node : nodes) {
        spring.carriers.push_back(node);
        spring.weights.push_back(anchor.weights[k] / static_cast<double>(nodes.size()));
      }
    }
    springs.push_back(std::move(spring));
  }
  return std::make_unique<WinklerFoundation>("foundation of " + body.name, springs, body.cover->foundation);
}

void add_couplings(const Scene& scene, const std::vector<BodyShape>& shapes, Model& model) {
  for (std::size_t k = 1; k < shapes.size(); ++k) {
    const scene::Body &body = scene.bodies[k], &shell = scene.bodies[k - 1];
    if (!body.cover) continue;
    const BodyShape& shape = shapes[k];
    const TriangleMesh surface = carrying_surface(shapes[k - 1], body.cover->surface);
    CoupledMeshes meshes;
    meshes.name = "coupling of " + body.name;
    meshes.coarse_name = shell.name;
    meshes.prolongation = &*shape.prolongation;
    meshes.coarse_nodes = shape.carriers;
    meshes.first_fine_node = shape.first_node;
    meshes.nodes = model.positions.size() / 3;
    meshes.scene_size = scene_size(model.positions);
    // Only this solver asks for the basis, which takes long where few fine vertices meet coarse ones.
    if (scene.solver.method == scene::SolverMethod::null_space)
      meshes.invisible = complementary_basis(surface, *shape.prolongation, body.name);
    model.equalities.push_back(std::make_unique<LinearEqualities>(couple(meshes)));
    note_far_points(body, shape, bounding_box_diagonal(surface), model);
    note_wavelength(shell, body, surface, model);
    if (has_pins(shape, model)) note_redundance(*model.equalities.back(), model);
  }
}

}  // namespace taut
