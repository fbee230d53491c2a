#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/constraint.h"
#include "core/energy.h"
#include "core/linear_equalities.h"

namespace taut {

/// minimise sum of energies(x) subject to c_k(x) in K_k for each constraint, A x = b for each system of equalities, and
/// x_i = value_i for each fixed variable. Energies, constraints and equalities are borrowed: whoever builds the problem
/// keeps them alive.
struct Problem {
  std::string name;
  Vector initial_guess;  ///< also says how many variables there are
  std::vector<const Energy*> energies;
  std::vector<const Constraint*> constraints;
  std::vector<const LinearEqualities*> equalities;
  std::vector<int> fixed_variables;  ///< ascending
  Vector fixed_values;               ///< as long as fixed_variables
  int node_size = 3;                 ///< variables that form one node, for nodal norms of forces
  double least_force_scale = 0;      ///< of Residuals::force_scale, where all terms may vanish at the solution
  /// Problems with the same non-zero number have the same energies, constraints, stencils, equalities (but for their
  /// values) and fixed variables, so that a solver may keep its pattern and symbolic factor from one to the next. 0:
  /// not known.
  std::uint64_t topology = 0;

  Index size() const { return initial_guess.size(); }
  /// Throws std::invalid_argument naming what does not fit.
  void validate() const;
};

/// A number that no earlier call has returned.
std::uint64_t new_topology();

}  // namespace taut
