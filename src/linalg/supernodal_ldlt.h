#pragma once

#include <memory>
#include <vector>

#include "core/types.h"

namespace taut {

/// Sparse L D L^T factor of a symmetric matrix, D diagonal, without pivoting: the order is kept whatever the values, as
/// quasi-definite matrices allow [Vanderbei 1995]. Left-looking on the supernodes that CHOLMOD finds, so that nearly
/// all of the work is in BLAS products. One symbolic analysis, then any number of numeric factorisations into the same
/// memory. Where a pivot is small in its column, SymmetricIndefinite can do what this cannot.
class SupernodalLdlt {
 public:
  /// False where Taut was built without CHOLMOD's supernodal module (docs/licences.md); the constructor throws there.
  static bool available();
  /// Analyses a pattern: each entry of the lower triangle, in any order, at `rows[k]`, `columns[k]`. order[k] is the
  /// row to place k-th.
  SupernodalLdlt(Index size, const std::vector<int>& rows, const std::vector<int>& columns,
                 const std::vector<int>& order);
  ~SupernodalLdlt();
  SupernodalLdlt(SupernodalLdlt&&) noexcept;
  SupernodalLdlt& operator=(SupernodalLdlt&&) noexcept;

  /// Factorises the matrix with these values, one per entry of the pattern; false where a pivot is below 1e-6 of the
  /// largest entry of its column or something is not finite.
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
