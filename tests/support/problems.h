#pragma once

#include <memory>
#include <vector>

#include "constraints/strain_limit.h"
#include "core/problem.h"
#include "core/solver.h"
#include "energies/inertia.h"

namespace taut {

/// A problem with the energies and constraints it borrows.
struct OwnedProblem {
  std::vector<std::shared_ptr<const Energy>> energies;
  std::vector<std::shared_ptr<const Constraint>> constraints;
  Problem problem;

  void add(std::shared_ptr<const Energy> energy) {
    problem.energies.push_back(energy.get());
    energies.push_back(std::move(energy));
  }
  void add(std::shared_ptr<const Constraint> constraint) {
    problem.constraints.push_back(constraint.get());
    constraints.push_back(std::move(constraint));
  }
  /// Holds all coordinates of these vertices at the initial guess; the vertices ascend.
  void pin(const std::vector<int>& vertices);
};

/// A strip along y from 0 to `length`, one cell wide, `rows` cells long: its two sides are chains of equal elements,
/// because in right triangles the derivative along y sees one side only.
struct Strip {
  TriangleMesh mesh;
  std::vector<RestTriangle> triangles;
  double width, length;
  int rows;
  Strip(double strip_width, double strip_length, int strip_rows);

  /// `value` per row, shared by its two vertices; half of that in the first and the last row.
  Vector row_values(double value) const;
  /// Lumped inertia with these masses per row (kg), as row_values() spreads them.
  std::shared_ptr<Inertia> inertia(double row_mass) const;
  /// Nodal forces `force` times row_values(1).
  Vector row_forces(const Vector3& force) const;
};

}  // namespace taut
