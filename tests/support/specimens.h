#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/constraint.h"
#include "core/energy.h"
#include "geometry/triangle_mesh.h"
#include "support/derivative_check.h"

namespace taut {

/// How the specimen sheet is deformed.
enum class Pose {
  crumpled,        ///< flat with every vertex moved by up to 2 % of an edge
  stretched,       ///< by about 1.3 and 0.75, turned in space, and moved likewise
  bent,            ///< rolled up, and moved likewise
  uniform,         ///< exactly 1.2 in every direction: coincident singular values
  nearly_uniform,  ///< 1.2 and 1.2 + 1e-6
};
std::string to_string(Pose pose);
std::vector<Pose> all_poses();

/// A small unstructured sheet of edge length about 1, flat at rest.
TriangleMesh specimen_sheet();
/// Its vertices in a pose, three coordinates each.
Vector posed(Pose pose);
/// Points beside the sheet, with z as their height over it, in a pose.
Vector posed_points(const std::vector<Vector3>& rest, Pose pose);

/// One kind of energy as the derivative test sees it.
struct EnergySpecimen {
  std::string name;
  SemidefiniteForm form;
  std::function<std::shared_ptr<const Energy>()> make;  ///< on specimen_sheet(), with whatever it borrows kept alive
  std::function<Vector(Pose)> posed = taut::posed;      ///< all variables of its mesh in a pose
};
/// Every energy in src/energies/ and src/dynamics/. A new energy adds its line here.
std::vector<EnergySpecimen> energy_specimens();

/// One kind of constraint.
struct ConstraintSpecimen {
  std::string name;
  std::function<std::shared_ptr<const Constraint>()> make;
  std::set<Pose> kinks = {};  ///< poses where it has no second derivative
  bool interior = true;       ///< its set has inner points: there is a central path
};
/// Every constraint in constraints/ and src/dynamics/. A new constraint adds its line here.
std::vector<ConstraintSpecimen> constraint_specimens();

/// What GoogleTest calls a parametrised case.
void PrintTo(const EnergySpecimen& specimen, std::ostream* out);
void PrintTo(const ConstraintSpecimen& specimen, std::ostream* out);

}  // namespace taut
