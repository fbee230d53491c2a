#pragma once

#include <Eigen/SparseCholesky>

#include "core/problem.h"
#include "solvers/newton.h"

namespace taut {

/// Newton steps in the null space of linear equalities: x = x0 + Z w with a sparse basis Z (linalg/null_space.h), w
/// from (Z^T H Z) w = -Z^T g, factorised by Eigen's simplicial Cholesky. It shares neither order nor factorisation nor
/// the treatment of fixed variables with SubstitutedSystem, which makes it a check of that, not a fast solver: the
/// product is formed anew in each iteration.
class NullSpaceSystem final : public NewtonSystem {
 public:
  /// The equalities are those that hold the problem's fixed variables. The assembly, which is borrowed, has no fixed
  /// variables and the natural order.
  NullSpaceSystem(const Assembly& assembly, const Problem& problem);
  bool factorize(double shift) override;
  void solve(const Vector& gradient, Vector& step) override;

 private:
  const Assembly& assembly_;
  SparseMatrix basis_, reduced_;
  Eigen::SimplicialLLT<SparseMatrix> cholesky_;
  bool analysed_ = false;
};

}  // namespace taut
