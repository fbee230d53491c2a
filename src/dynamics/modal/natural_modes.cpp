#include "dynamics/modal/natural_modes.h"

#include <cmath>
#include <numbers>

#include "core/assembly.h"
#include "dynamics/modal/eigen_solver.h"
#include "linalg/cholesky.h"

namespace taut {
namespace {

/// The mass matrix in the order of `stiffness`. Its unit rows of pinned coordinates become zero: nothing moves there.
SparseMatrix ordered_mass(const Model& model, const std::vector<int>& fixed, const std::vector<int>& order,
                          const Assembly& stiffness, int threads) {
  const Index size = model.positions.size();
  std::vector<Inertia> inertia;
  for (const auto& part : model.inertia) {
    inertia.push_back(*part);
    inertia.back().set_target(1, model.positions);
  }
  std::vector<const Energy*> energies;
  energies.reserve(inertia.size());
  for (const Inertia& part : inertia) energies.push_back(&part);
  Assembly assembly(size, energies, fixed, threads);
  assembly.set_order(order);
  assembly.hessian(model.positions, Curvature::exact);
  SparseMatrix mass = assembly.matrix();
  Vector pinned = Vector::Zero(size), ordered;
  for (const int variable : fixed) pinned[variable] = 1;
  stiffness.to_ordered(pinned, ordered);
  for (Index row = 0; row < mass.rows(); ++row) {
    if (ordered[row] != 0) mass.coeffRef(row, row) = 0;
  }
  return mass;
}

}  // namespace

std::vector<NaturalMode> natural_modes(const Model& model, const std::vector<const Energy*>& energies, const Vector& x,
                                       int count, int threads) {
  std::vector<int> fixed;
  for (const PinnedVariable& pin : model.pins) fixed.push_back(pin.variable);
  Assembly stiffness(x.size(), energies, fixed, threads);
  const std::vector<int> order = fill_reducing_order(stiffness.graph());
  stiffness.set_order(order);
  stiffness.hessian(x, Curvature::exact);
  const EigenSolver solver(stiffness.matrix(), ordered_mass(model, fixed, order, stiffness, threads), threads);
  std::vector<NaturalMode> modes;
  for (const EigenPair& pair : solver.lowest(count)) {
    NaturalMode mode{
        std::copysign(std::sqrt(std::abs(pair.value)), pair.value) / (2 * std::numbers::pi), {}, pair.residual};
    stiffness.from_ordered(pair.vector, mode.shape);
    modes.push_back(std::move(mode));
  }
  return modes;
}

}  // namespace taut
