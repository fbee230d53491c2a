#pragma once

#include <vector>

#include "energies/inertia.h"
#include "geometry/prism.h"

namespace taut {

/// One number per pair of the six nodes of a prism; it applies to each of the three coordinates.
using PrismMass = Eigen::Matrix<double, 6, 6>;

/// Consistent mass (MLTS (10)) on mid-surface positions and directors (x1, x2, x3, n1, n2, n3), integrated exactly, in
/// kg; `density` in kg/m^3. With T_ijk = 6, 2, 1 over 120 for three, two, no equal indices (ERRATA of MLTS (13)-(19)):
/// M_ij = rho sum_k T_ijk (2 G_k + 2/3 I), M_i,j+3 = 2/3 rho sum_k T_ijk H_k,
/// M_i+3,j+3 = rho sum_k T_ijk (2/3 G_k + 2/5 I).
PrismMass director_mass(const PrismShape& shape, double density);

/// The same on the surface nodes y1 ... y6 (MLTS (23)), which are what the solver sees.
PrismMass surface_mass(const PrismShape& shape, double density);

/// Inertia of prisms, consistent (six nodes an element) or with the row sums of the consistent mass on the nodes, which
/// are positive wherever the prism is not inverted. The gravity of MLTS (20)-(21) is M g: Inertia::add_product().
/// `nodes`: those of the prisms, m; `first_node` is added to the prisms' indices; `density` in kg/m^3. Throws
/// std::invalid_argument where a prism is inverted.
Inertia consistent_prism_inertia(std::string name, const std::vector<Prism>& prisms, const std::vector<Vector3>& nodes,
                                 double density, int first_node = 0);
Inertia lumped_prism_inertia(std::string name, const std::vector<Prism>& prisms, const std::vector<Vector3>& nodes,
                             double density, int first_node = 0);

}  // namespace taut
