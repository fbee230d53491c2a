#pragma once

#include <memory>
#include <vector>

#include "core/types.h"

namespace taut {

/// Sparse L D L^T factor of a symmetric matrix that may be indefinite, with 1x1 and 2x2 pivots (MUMPS). The matrix is
/// taken as it comes: rows and columns of very different size are for the caller to scale. One symbolic
/// analysis, then any number of numeric factorisations.
class SymmetricIndefinite {
 public:
  /// Analyses a pattern: each entry of the lower triangle, in any order, at `rows[k]`, `columns[k]`. `order` is a
  /// fill-reducing order, order[k] the row to place k-th; empty: SCOTCH's.
  SymmetricIndefinite(Index size, const std::vector<int>& rows, const std::vector<int>& columns,
                      const std::vector<int>& order = {});
  ~SymmetricIndefinite();
  SymmetricIndefinite(SymmetricIndefinite&&) noexcept;
  SymmetricIndefinite& operator=(SymmetricIndefinite&&) noexcept;

  /// Factorises the matrix with these values, one per entry of the pattern; false where it is singular or not finite.
  bool factorize(const Vector& values);
  /// Number of negative eigenvalues of the last matrix, which are its negative pivots.
  Index negative_pivots() const;
  /// Replaces the right-hand side by the solution.
  void solve(Vector& x) const;

  double factor_nonzeros() const;
  double factor_flops() const;
  std::size_t memory_bytes() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace taut
