#pragma once

#include <string>
#include <vector>

#include "core/types.h"
#include "dynamics/model.h"

namespace taut {

/// Modes of a body and the rotations that go with them: K Phi = M Phi Lambda, Phi^T M Phi = I, Psi = curl Phi / 2.
/// Reduced coordinates q are in kg^(1/2) m.
struct ModalBasis {
  Vector rest;                       ///< positions of the nodes without displacement, 3 entries a node, m
  Matrix shapes;                     ///< Phi, 3 nodes x modes, kg^(-1/2)
  Matrix rotations;                  ///< Psi, 3 nodes x modes, rad kg^(-1/2) m^(-1)
  Vector eigenvalues;                ///< Lambda, ascending, exactly zero for rigid motions, 1/s^2
  Vector residuals;                  ///< EigenPair::residual of each
  int rigid = 0;                     ///< how many of the first are rigid motions
  bool warped = true;                ///< false: u = Phi q, the linear modes
  std::string mesh_hash, body_hash;  ///< what it was computed from (files that hold it are refused by others)

  Index modes() const { return shapes.cols(); }
  Index nodes() const { return rest.size() / 3; }
  /// rest + R~(Psi q) Phi q, 3 entries a node.
  Vector positions(const Vector& q) const;
  /// Those of the nodes at the velocities v of q.
  Vector velocities(const Vector& q, const Vector& v) const;
  /// d position of a node / d q, 3 x modes: R~ Phi + (dR~/dw) Phi q Psi.
  Matrix jacobian(Index node, const Vector& q) const;
  /// The q whose positions are nearest to x, by Gauss-Newton steps from `guess`.
  Vector coordinates(const Vector& x, Vector guess) const;
  /// The v whose velocities at q are nearest to `rates`.
  Vector rates(const Vector& q, const Vector& rates) const;
  /// The first `modes` of them.
  ModalBasis truncated(Index modes) const;
};

/// The operator that averages half the curl of a displacement field at the nodes from the elements around, weighted by
/// area or volume: 3 nodes x 3 nodes. On a surface the rotation of the normal stands in for the transverse derivative
/// (Kirchhoff).
SparseMatrix surface_curl(const std::vector<Vector3>& points, const std::vector<Triangle>& triangles);
/// Of prisms (bottom and top of each vertex in turn), from the gradients at their nodes.
SparseMatrix prism_curl(const std::vector<Vector3>& points, const std::vector<std::array<int, 6>>& prisms);
/// Of tetrahedra.
SparseMatrix tetrahedron_curl(const std::vector<Vector3>& points, const std::vector<std::array<int, 4>>& cells);

/// The `count` lowest modes of a model of one body about its start, its pins held. Where nothing is pinned the six
/// rigid motions come first, exactly. Throws std::invalid_argument where the start is no equilibrium, where a value is
/// negative, or where more than six motions cost no energy (a membrane without bending or tension); else as
/// EigenSolver.
ModalBasis modal_basis(const Model& model, const SparseMatrix& curl, int count, int threads);

}  // namespace taut
