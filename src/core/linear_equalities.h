#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/types.h"

namespace taut {

/// Equations A x = b that hold exactly, for rows with any number of variables: what couples two meshes. (Constraint is
/// for elements with few; pins are fixed variables.) With multipliers nu the Lagrangian gains nu . (A x - b), so that
/// the force they exert on the nodes is -A^T nu.
struct LinearEqualities {
  std::string name;
  SparseMatrix rows;                             ///< A: equations x variables
  Vector values;                                 ///< b
  double violation_scale = 1;                    ///< what a violation of "one" means, as in Constraint
  std::function<std::string(Index)> row_name{};  ///< "vertex 3 of quilt, z"
  /// A basis Z of the null space of A, variables x (variables - rank), where whoever made the equations has one: A Z =
  /// 0 to round-off and full rank. Empty: a solver that needs one finds it.
  SparseMatrix null_space{};
  /// Variables of the side that follows the other, a cover's, ascending: for solvers that take the sides in turn. Empty
  /// where that is not known.
  std::vector<int> following{};
};

}  // namespace taut
