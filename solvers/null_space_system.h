#pragma once

#include <Eigen/SparseCholesky>

#include "core/problem.h"
#include "solvers/equality_rows.h"
#include "solvers/newton.h"

namespace taut {

/// Newton steps in the null space of all equalities, the fixed variables' among them: x = x0 + Z w with a sparse basis
/// Z, w from (Z^T H Z) w = -Z^T g, factorised by Eigen's simplicial Cholesky. Z is LinearEqualities::null_space where
/// that is known (for a membrane on a shell the change of variables of [MLTS (37)]), else found by QR
/// (linalg/null_space.h). It shares neither order nor factorisation nor the treatment of equalities with the other
/// systems, which makes it a check of them, not a fast solver: the product is formed anew in each iteration.
///
/// Where the product fills in (many fine vertices to a coarse one), conjugate gradients on w do without it, with the
/// diagonal of Z^T diag(H) Z as preconditioner. Along negative curvature they stop at the step they have [Steihaug
/// 1983]; factorize() cannot tell then whether the matrix is positive definite.
class NullSpaceSystem final : public NewtonSystem {
 public:
  /// The assembly, which is borrowed, has no fixed variables and the natural order.
  NullSpaceSystem(const Assembly& assembly, const EqualityRows& equalities, const Problem& problem,
                  bool conjugate_gradients = false);
  bool factorize(double shift) override;
  bool solve(const Vector& gradient, const Vector& violation, Vector& step, Vector& multiplier_step) override;
  Size size() const override;
  Effort effort() const override { return effort_; }

 private:
  Vector reduced_solution(const Vector& force);
  Vector by_conjugate_gradients(const Vector& right_hand_side);

  const Assembly& assembly_;
  std::vector<int> fixed_;
  SparseMatrix basis_, reduced_;
  SparseMatrix rows_;  // the equalities without the columns of fixed variables
  Eigen::SimplicialLLT<SparseMatrix> cholesky_;
  Eigen::SimplicialLDLT<SparseMatrix> normal_;  // A A^T, for particular solutions and multipliers
  double shift_ = 0;
  bool conjugate_gradients_;
  Vector preconditioner_;  // of Z^T H Z
  bool analysed_ = false;
  Effort effort_;
};

}  // namespace taut
