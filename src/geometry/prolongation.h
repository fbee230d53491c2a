#pragma once

#include <string>
#include <utility>
#include <vector>

#include "geometry/topology.h"

namespace taut {

/// A fine point in a coarse triangle.
struct Anchor {
  int triangle = 0;
  Vector3 weights = Vector3::Zero();  ///< barycentric, sum 1; below 1e-9 in size they are exactly 0, and what is within
                                      ///< 1e-9 of a vertex has that vertex alone
  double distance = 0;                ///< from the coarse surface, m
};

/// How the points of a fine mesh follow the vertices of a coarse one: x = P y, [MLTS 2.1].
struct Prolongation {
  SparseMatrix weights;         ///< P: fine points x coarse vertices, the same for each coordinate; rows sum to 1
  std::vector<Anchor> anchors;  ///< one per fine point
};

/// The mesh with every triangle divided into four, `levels` times over, by the middles of its edges: 2^levels fine
/// edges on each coarse one. The coarse vertices come first, with their numbers; groups keep the vertices they had,
/// and those between two of them. Throws std::invalid_argument for levels outside 0 to 8.
std::pair<TriangleMesh, Prolongation> refine(const TriangleMesh& coarse, int levels);

/// For points of any other mesh: the nearest point of the coarse surface. Beside a boundary edge the plane of its
/// triangle goes on, so that weights may be negative there.
///
/// Throws MeshError, in one line that begins with `label`, the name of the fine mesh, where two points are the same
/// (within 1e-9 of the mesh's size), where a coarse vertex has no weight in any of them, or where a sum of weights,
/// P^T 1, is not positive.
Prolongation prolongation(const TriangleMesh& coarse, const std::vector<Vector3>& points, const std::string& label);

/// P y for points, or vectors, at the coarse vertices.
std::vector<Vector3> prolonged(const Prolongation& prolongation, const std::vector<Vector3>& coarse);

/// A sparse right inverse C of P^T: P^T C = I, coarse vertices as columns. A column has one entry where a fine point is
/// at the vertex, three where three fine points of one triangle span it, else the least-norm solution on a patch of
/// triangles that grows until it has one. Throws MeshError, beginning with `label`, at a vertex where not even all
/// points have one: P is rank deficient.
SparseMatrix right_inverse(const TriangleMesh& coarse, const Prolongation& prolongation, const std::string& label);

/// A sparse basis of the null space of P^T: fine points x (fine - coarse) with P^T Q = 0 and [P Q] regular, by
/// Q = (I - C P^T) E, C the right inverse and E the points that are left when pivots of C are taken away. Where each
/// coarse vertex has one fine point of its own it is that of [MLTS 2.3].
SparseMatrix complementary_basis(const TriangleMesh& coarse, const Prolongation& prolongation,
                                 const std::string& label);

/// Number of the nearest triangle for each point, by CGAL's AABB tree, or one by one where the library was built
/// without CGAL.
std::vector<int> nearest_triangles(const TriangleMesh& mesh, const std::vector<Vector3>& points);

}  // namespace taut
