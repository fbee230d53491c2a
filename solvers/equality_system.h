#pragma once

#include <memory>
#include <optional>

#include "linalg/supernodal_ldlt.h"
#include "linalg/symmetric_indefinite.h"
#include "solvers/equality_rows.h"
#include "solvers/newton.h"

namespace taut {

/// Newton steps with linear equalities, H dx + A^T dnu = -gradient, A dx = -violation, fixed variables substituted. A
/// subclass solves this with -1/mu in the lower right corner, which is the augmented Lagrangian's step [H A^T; A -1/mu]
/// with a penalty mu on each row. Refinement takes the effect of 1/mu away: each round is an update of the multipliers
/// nu, and the equalities hold to round-off.
class EqualitySystem : public NewtonSystem {
 public:
  bool factorize(double shift) final;
  bool solve(const Vector& gradient, const Vector& violation, Vector& step, Vector& multiplier_step) final;

 protected:
  /// All is borrowed. The assembly is in its final order, which QuasiDefiniteSystem wants to be the natural one.
  EqualitySystem(const Assembly& assembly, const EqualityRows& equalities, const std::vector<int>& fixed);

  const Assembly& assembly() const { return assembly_; }
  /// A with columns in the assembly's order, those of fixed variables zero.
  const SparseMatrix& rows() const { return rows_; }
  /// mu of each row: 1e8 times the stiffness against it that the diagonal of H tells.
  const Vector& penalties() const { return penalties_; }

  virtual bool factorize_penalised(double shift) = 0;
  /// Replaces right-hand sides of the system with -1/mu by its solution.
  virtual void solve_penalised(Vector& step, Vector& multipliers) = 0;

 private:
  void find_penalties(double shift);

  const Assembly& assembly_;
  SparseMatrix rows_;
  double shift_ = 0;
  Vector penalties_, top_, bottom_, dx_, dnu_, part_, part_nu_, ordered_;
};

/// The system as it stands, factorised without pivoting, by MUMPS where that meets a small pivot. Negative pivots are
/// counted: as many as rows, or H is not positive definite where A dx = 0.
class QuasiDefiniteSystem final : public EqualitySystem {
 public:
  QuasiDefiniteSystem(const Assembly& assembly, const EqualityRows& equalities, const std::vector<int>& fixed);
  /// Of the last matrix on A dx = 0; nothing where it was singular.
  std::optional<Index> negative_curvatures() const { return negative_curvatures_; }
  Size size() const override;
  Effort effort() const override { return {.pivoted = pivoted_}; }

 private:
  bool factorize_penalised(double shift) override;
  void solve_penalised(Vector& step, Vector& multipliers) override;
  bool factorize_values();

  std::vector<Index> slots_;  // entries of the assembled matrix in the lower triangle
  std::vector<Index> diagonal_;
  Vector scales_, values_, right_hand_side_;
  std::optional<Index> negative_curvatures_;
  // Of the whole system: entries of the lower triangle and order.
  std::vector<int> row_of_, column_of_, order_;
  std::unique_ptr<SupernodalLdlt> factor_;            // null where it is not available
  std::unique_ptr<SymmetricIndefinite> with_pivots_;  // made when first needed
  bool use_pivots_ = false;                           // in solves with the last matrix
  Index pivoted_ = 0;
};

/// The multipliers eliminated, H + sum mu a a^T, factorised by CHOLMOD: every row couples all of its variables with
/// each other. It is here to be compared.
class PenalisedRowsSystem final : public EqualitySystem {
 public:
  /// The order of the assembly is set to one that fits.
  PenalisedRowsSystem(Assembly& assembly, const EqualityRows& equalities, const std::vector<int>& fixed, int threads);
  Size size() const override {
    return {cholesky_->factor_flops(), cholesky_->factor_nonzeros(), cholesky_->memory_bytes()};
  }

 private:
  bool factorize_penalised(double shift) override;
  void solve_penalised(Vector& step, Vector& multipliers) override;

  SparseMatrix sum_;
  Vector right_hand_side_;
  std::unique_ptr<Cholesky> cholesky_;
};

}  // namespace taut
