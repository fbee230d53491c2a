#pragma once

#include <memory>
#include <vector>

#include "core/assembly.h"

namespace taut {

/// A nested-dissection order of a graph: order[k] is the node to place k-th (METIS, then CHOLMOD's postorder). Same
/// graph, same order.
std::vector<int> fill_reducing_order(const GroupGraph& graph);

/// Sparse Cholesky factor L L^T of a matrix whose pattern never changes (CHOLMOD, supernodal). The matrix comes in its
/// final order, lower triangle (entries above the diagonal are ignored). One symbolic analysis, then any number of
/// numeric factorisations into the same memory. Large matrices are factorised on two threads by SubtreeCholesky.
class Cholesky {
 public:
  /// Analyses the pattern. `threads` is the most that factorisations (of 40,000 rows or more) and rough solves may use.
  Cholesky(const SparseMatrix& lower, int threads);
  ~Cholesky();
  Cholesky(Cholesky&&) noexcept;
  Cholesky& operator=(Cholesky&&) noexcept;

  /// Factorises matrix + shift I; false where that is not positive definite or not finite.
  bool factorize(const SparseMatrix& lower, double shift = 0.0);
  /// Solves with the last factor; `x` may be `b`.
  void solve(const Vector& b, Vector& x);
  /// The same to about six digits, for preconditioners: with the factor in single precision, rounded at the first such
  /// solve after a factorisation, which halves the memory that the solve has to read.
  void solve_roughly(const Vector& b, Vector& x);

  double factor_nonzeros() const;
  double factor_flops() const;
  std::size_t memory_bytes() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace taut
