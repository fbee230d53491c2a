#pragma once

#include <string>
#include <vector>

#include "core/linear_equalities.h"
#include "geometry/prolongation.h"

namespace taut {

/// A fine mesh on a coarse surface, by scene nodes.
struct CoupledMeshes {
  std::string name;                            ///< of the constraint
  std::string coarse_name;                     ///< of the coarse body
  const Prolongation* prolongation = nullptr;  ///< borrowed while the constraint is made
  /// The nodes whose mean is the point of the surface at each coarse vertex: one, or for the middle of a prism two.
  std::vector<std::vector<int>> coarse_nodes;
  int first_fine_node = 0;
  Index nodes = 0;         ///< of the whole scene
  double scene_size = 1;   ///< m, for LinearEqualities::violation_scale
  SparseMatrix invisible;  ///< complementary_basis() of the prolongation, or empty
};

/// D^{-1} P^T (x - P y) = 0 with D = diag(P^T 1): around each coarse vertex the weighted mean distance of the fine
/// membrane from the surface is zero, in m [MLTS (28), scaled]. The multiplier of a row is the whole force, in N, that
/// the vertex exerts on the fine membrane. Where `invisible` Q is given, the null space is that of [MLTS (37)]:
/// the columns are the nodes that are not fine, which carry the fine ones along by P, then those of Q.
LinearEqualities couple(const CoupledMeshes& meshes);

/// Takes from each fine position what keeps P^T (x - P y) from being zero, by the least change.
void make_compatible(const Prolongation& prolongation, const std::vector<Vector3>& surface, std::vector<Vector3>& fine);

}  // namespace taut
