#include <Eigen/Geometry>

#include "energies/prism_mass.h"
#include "energies/prism_shell.h"
#include "problems/build_parts.h"

namespace taut {
namespace {

/// Prisms of the levels from `first` to before `last`.
std::vector<Prism> prisms_of_levels(const BodyShape& shape, int first, int last) {
  const auto triangles = static_cast<std::ptrdiff_t>(shape.mesh.triangles.size());
  const auto begin = shape.layered->prisms.begin();
  return {begin + first * triangles, begin + last * triangles};
}

/// The shell's direction turned by the layer's angle in the middle triangle of the prism.
Vector3 fibres(const Scene& scene, const scene::Body& body, const scene::Layer& layer, const RestPrism& prism,
               std::size_t triangle) {
  const PrismShape points(prism.points);
  const Vector3 normal =
      (points.mid.col(1) - points.mid.col(0)).cross(points.mid.col(2) - points.mid.col(0)).normalized();
  const Vector3& direction = body.shell->direction;
  if (layer.has_fibres && !(direction.cross(normal).norm() > 0.02)) {
    throw InputError(scene.source, "/bodies/" + body.name + "/shell/direction",
                     "found the normal of triangle " + std::to_string(triangle) +
                         ", allowed: a direction that has a part in every triangle");
  }
  return Eigen::AngleAxisd(layer.fibre_angle, normal) * (direction - direction.dot(normal) * normal);
}

std::vector<RestPrism> rest_prisms_of(const Scene& scene, const scene::Body& body, const scene::Layer& layer,
                                      const BodyShape& shape, const std::vector<Prism>& prisms) {
  std::vector<RestPrism> rest = rest_prisms(prisms, shape.layered->nodes, body.shell->direction, shape.first_node);
  for (std::size_t p = 0; p < rest.size(); ++p)
    rest[p].direction = fibres(scene, body, layer, rest[p], p % shape.mesh.triangles.size());
  return rest;
}

}  // namespace

std::vector<std::unique_ptr<Energy>> add_shell(const Scene& scene, const scene::Body& body, const BodyShape& shape,
                                               Model& model) {
  std::vector<std::unique_ptr<Energy>> elastic;
  const std::vector<scene::Layer>& layers = body.shell->layers;
  std::vector<ShellSection::Layer> section;
  int level = 0;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const scene::Layer& layer = layers[k];
    const std::string of = (layers.size() == 1 ? "" : "layer " + std::to_string(k) + " of ") + body.name;
    const std::vector<Prism> prisms = prisms_of_levels(shape, level, level + layer.prisms);
    level += layer.prisms;
    const auto inertia = body.mass == scene::Mass::lumped ? lumped_prism_inertia : consistent_prism_inertia;
    model.inertia.push_back(std::make_unique<Inertia>(
        inertia("inertia of " + of, prisms, shape.layered->nodes, layer.density, shape.first_node)));
    model.mass_damping.push_back(body.damping.mass);
    auto energy = std::make_unique<PrismShell>("shell of " + of, rest_prisms_of(scene, body, layer, shape, prisms),
                                               layer.material, body.shell->options);
    section.push_back({energy.get(), layer.prisms});
    elastic.push_back(std::move(energy));
  }
  const auto index = static_cast<int>(&body - scene.bodies.data());
  model.shells.push_back(
      {index, ShellSection(std::move(section), shape.layered->prisms, shape.layered->nodes, body.shell->direction)});
  model.surfaces.insert(model.surfaces.end(), shape.rest.begin(), shape.rest.end());
  return elastic;
}

}  // namespace taut
