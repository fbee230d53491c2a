#include "support/specimens.h"

#include <cmath>
#include <ostream>
#include <stdexcept>

#include "constraints/obstacle.h"
#include "constraints/strain_limit.h"
#include "dynamics/modal/modal_energies.h"
#include "dynamics/modal/warped_position.h"
#include "energies/dead_load.h"
#include "energies/end_moment.h"
#include "energies/foundation.h"
#include "energies/hinge_bending.h"
#include "energies/inertia.h"
#include "energies/membrane.h"
#include "energies/pressure.h"
#include "energies/prism_mass.h"
#include "energies/prism_shell.h"
#include "energies/stiffness_damping.h"
#include "geometry/layered_mesh.h"
#include "support/meshes.h"
#include "support/random_values.h"
#include "support/small_basis.h"

namespace taut {
namespace {

std::vector<RestTriangle> sheet_triangles() {
  const TriangleMesh mesh = specimen_sheet();
  return rest_triangles(mesh.triangles, mesh.vertices);
}

std::shared_ptr<const Energy> make_inertia(Inertia inertia) {
  inertia.set_target(50.0, RandomValues(11).vector(3 * static_cast<Index>(specimen_sheet().vertices.size())));
  return std::make_shared<Inertia>(std::move(inertia));
}

std::shared_ptr<const Energy> make_membrane(MembraneLaw law) {
  return std::make_shared<Membrane>("membrane", sheet_triangles(), law, Lame::plane_stress(700.0, 0.3), 0.5);
}

std::shared_ptr<const Energy> make_bending(const std::vector<Vector3>& rest) {
  return std::make_shared<HingeBending>("bending", make_hinges(specimen_sheet().triangles, rest, 2.0, false));
}

std::shared_ptr<const Energy> make_damping() {
  struct Damped {
    std::shared_ptr<const Energy> membrane = make_membrane(MembraneLaw::stvk);
    StiffnessDamping damping{"damping", *membrane};
  };
  const auto damped = std::make_shared<Damped>();
  damped->damping.set_reference(0.7, posed(Pose::stretched));
  return {damped, &damped->damping};
}

/// Prisms on the sheet, bent and of uneven thickness at rest.
LayeredMesh specimen_prisms() {
  TriangleMesh mesh = specimen_sheet();
  RandomValues random(4);
  for (Vector3& vertex : mesh.vertices) vertex.z() = 0.1 * random.value();
  std::vector<double> thickness;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) thickness.push_back(random.between(0.3, 0.5));
  return make_layered(mesh, thickness, {1.0}, "specimen");
}

EnergySpecimen prism_specimen(const std::string& name, const SolidMaterial& material, PrismShellOptions options) {
  const auto make = [=]() -> std::shared_ptr<const Energy> {
    const LayeredMesh mesh = specimen_prisms();
    return std::make_shared<PrismShell>("shell", rest_prisms(mesh.prisms, mesh.nodes, {1, 1, 0}), material, options);
  };
  return {"prism_" + name, SemidefiniteForm::majorant, make,
          [](Pose pose) { return posed_points(specimen_prisms().nodes, pose); }};
}

std::vector<EnergySpecimen> prism_specimens() {
  const auto stvk = SolidMaterial::isotropic(SolidLaw::stvk, 700, 0.3);
  const auto neo_hookean = SolidMaterial::isotropic(SolidLaw::neo_hookean, 700, 0.3);
  const auto soft = SolidMaterial::isotropic(SolidLaw::neo_hookean, 700, 0.49);
  const auto ply = SolidMaterial::ply({2500, 100, 50, 20, 0.25, 0.25});
  PrismShellOptions plain, uncured, fine, stabilised;
  plain.element = PrismElement::plain;
  uncured.enhanced_thickness = false;
  fine.points_in_plane = 6;
  fine.points_in_thickness = 3;
  stabilised.shear_stabilisation = 0.1;
  stabilised.shear_correction = 5.0 / 6;
  return {prism_specimen("plain_stvk", stvk, plain),
          prism_specimen("plain_neo_hookean", neo_hookean, plain),
          prism_specimen("assumed_stvk", stvk, {}),
          prism_specimen("assumed_neo_hookean", neo_hookean, {}),
          prism_specimen("assumed_neo_hookean_soft", soft, fine),
          prism_specimen("uncured_neo_hookean", neo_hookean, uncured),
          prism_specimen("assumed_ply_stabilised", ply, stabilised)};
}

/// Modal ones have the first coordinates of the sheet for modes.
constexpr int modes = 8;

std::vector<int> sheet_vertices() {
  std::vector<int> vertices(specimen_sheet().vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] = static_cast<int>(i);
  return vertices;
}

std::shared_ptr<const Constraint> make_half_space() {
  auto half_space = std::make_shared<HalfSpace>("floor", "cloth", sheet_vertices(), 0, 1.0);
  half_space->place({0, 0, 4}, {0.3, -0.2, 1});
  return half_space;
}

std::shared_ptr<const Constraint> make_sphere() {
  auto sphere = std::make_shared<SphereObstacle>("ball", "cloth", sheet_vertices(), 0, 1.0, 9.0);
  sphere->place({1.1, 0.9, -1.5});
  return sphere;
}

}  // namespace

std::string to_string(Pose pose) {
  switch (pose) {
    case Pose::crumpled:
      return "crumpled";
    case Pose::stretched:
      return "stretched";
    case Pose::bent:
      return "bent";
    case Pose::uniform:
      return "uniform";
    case Pose::nearly_uniform:
      return "nearly_uniform";
  }
  throw std::invalid_argument("to_string: not a Pose");
}

std::vector<Pose> all_poses() {
  return {Pose::crumpled, Pose::stretched, Pose::bent, Pose::uniform, Pose::nearly_uniform};
}

TriangleMesh specimen_sheet() {
  TriangleMesh mesh = make_grid(2, 2, 2, 2, Diagonals::alternating);
  RandomValues random(3);
  for (Vector3& vertex : mesh.vertices) vertex += 0.1 * Vector3(random.value(), random.value(), 0);
  return mesh;
}

Vector posed(Pose pose) { return posed_points(specimen_sheet().vertices, pose); }

Vector posed_points(const std::vector<Vector3>& points, Pose pose) {
  RandomValues random(5);
  const Matrix3 turn = random.rotation();
  const auto noise = [&] { return Vector3(0.02 * random.vector(3)); };
  return flatten(mapped(points, [&](const Vector3& rest) -> Vector3 {
    switch (pose) {
      case Pose::crumpled:
        return rest + noise();
      case Pose::stretched:
        return turn * Vector3(1.3 * rest.x(), 0.75 * rest.y(), rest.z()) + noise();
      case Pose::bent: {
        const double angle = 0.9 * rest.x();
        return turn * (rolled(rest, 0.9) + rest.z() * Vector3(-std::sin(angle), 0, std::cos(angle))) + noise();
      }
      case Pose::uniform:
        return 1.2 * rest;
      case Pose::nearly_uniform:
        return {1.2 * rest.x(), (1.2 + 1e-6) * rest.y(), 1.2 * rest.z()};
    }
    throw std::invalid_argument("posed: not a Pose");
  }));
}

std::vector<EnergySpecimen> energy_specimens() {
  const TriangleMesh mesh = specimen_sheet();
  const Index vertices = static_cast<Index>(mesh.vertices.size());
  const std::vector<Vector3> curved = mapped(mesh.vertices, [](const Vector3& v) { return rolled(v, -0.4); });
  using Form = SemidefiniteForm;
  std::vector<EnergySpecimen> all = {
      {"inertia_lumped", Form::projection,
       [=] { return make_inertia(Inertia::lumped("inertia", sheet_triangles(), 0.3, vertices)); }},
      {"inertia_consistent", Form::projection,
       [] { return make_inertia(Inertia::consistent("inertia", sheet_triangles(), 0.3)); }},
      {"dead_load", Form::projection,
       [=] { return std::make_shared<DeadLoad>("load", RandomValues(7).vector(3 * vertices)); }},
      {"membrane_stvk", Form::majorant, [] { return make_membrane(MembraneLaw::stvk); }},
      {"membrane_neo_hookean", Form::projection, [] { return make_membrane(MembraneLaw::neo_hookean); }},
      {"bending_flat_rest", Form::other, [=] { return make_bending(mesh.vertices); }},
      {"bending_curved_rest", Form::other, [=] { return make_bending(curved); }},
      {"pressure", Form::other, [=] { return std::make_shared<Pressure>("pressure", mesh.triangles, 3.0); }},
      {"foundation", Form::projection,
       [] {
         const std::vector<WinklerFoundation::Spring> springs{{0, {4, 5, 8}, {0.2, 0.5, 0.3}, 0.7},
                                                              {2, {3, 7, 8}, {1.1, -0.1, 0}, 0.4}};
         return std::make_shared<WinklerFoundation>("foundation", springs, 30.0);
       }},
      {"stiffness_damping", Form::majorant, make_damping},
      {"end_moment", Form::projection,
       [] {
         const LayeredMesh prisms = specimen_prisms();
         const std::vector<EndMoment::Load> loads{{0, 1, 0.3}, {4, 5, -0.2}};
         return std::make_shared<EndMoment>("moment", loads, Vector3(0.2, 1, 0.1), flatten(prisms.nodes));
       },
       [](Pose pose) { return posed_points(specimen_prisms().nodes, pose); }},
      {"inertia_prisms", Form::projection,
       [] {
         const LayeredMesh prisms = specimen_prisms();
         Inertia inertia = consistent_prism_inertia("inertia", prisms.prisms, prisms.nodes, 0.3);
         inertia.set_target(50.0, RandomValues(11).vector(3 * static_cast<Index>(prisms.nodes.size())));
         return std::make_shared<Inertia>(std::move(inertia));
       },
       [](Pose pose) { return posed_points(specimen_prisms().nodes, pose); }},
      {"modal_stiffness", Form::projection,
       [] { return std::make_shared<ModalStiffness>("modes", Vector::LinSpaced(modes, 1, 9)); }},
      {"warped_load", Form::projection,
       [] { return std::make_shared<WarpedLoad>("load", *random_basis(modes), RandomValues(4).vector(12)); }},
  };
  for (EnergySpecimen& specimen : prism_specimens()) all.push_back(std::move(specimen));
  return all;
}

std::vector<ConstraintSpecimen> constraint_specimens() {
  return {
      {"matrix_strain_limit",
       [] { return std::make_shared<MatrixStrainLimit>(limit_on(sheet_triangles(), 0.85, 1.12)); }},
      {"matrix_upper_limit", [] { return std::make_shared<MatrixStrainLimit>(limit_on(sheet_triangles(), 0, 1.12)); }},
      {"singular_value_strain_limit",
       [] { return std::make_shared<SingularValueStrainLimit>(limit_on(sheet_triangles(), 0.85, 1.12)); },
       // Where singular values meet they have corners; at 1e-6 from there the remainders are those of the corner.
       {Pose::crumpled, Pose::bent, Pose::uniform, Pose::nearly_uniform}},
      {"half_space", make_half_space},
      {"sphere_obstacle", make_sphere},
      {"warped_position",
       [] {
         const std::vector<WarpedPosition::Held> held{{0, 0}, {1, 2}, {3, 1}};
         return std::make_shared<WarpedPosition>("hand", "body", 1, random_basis(modes), held, 1.0);
       },
       {},
       false},
  };
}

void PrintTo(const EnergySpecimen& specimen, std::ostream* out) { *out << specimen.name; }
void PrintTo(const ConstraintSpecimen& specimen, std::ostream* out) { *out << specimen.name; }

}  // namespace taut
