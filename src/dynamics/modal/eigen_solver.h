#pragma once

#include <vector>

#include "core/types.h"

namespace taut {

/// A solution of K phi = lambda M phi with phi^T M phi = 1.
struct EigenPair {
  double value;     ///< lambda, in the unit of K over that of M
  Vector vector;    ///< phi
  double residual;  ///< |K phi - lambda M phi| over (|lambda| + s) |M phi|, s the largest |lambda| found
};

/// The lowest eigenpairs of K phi = lambda M phi for sparse symmetric K and M, M positive semidefinite, by Lanczos's
/// method on (K + s M)^-1 M (Spectra, with the Cholesky factor of K + s M).
///
/// K may be singular, as for a body that floats: its rigid modes have values near zero, at most round-off of the
/// largest value of the whole spectrum. It may be indefinite, as behind a bifurcation: values are negative then. Values
/// that occur several times are found as often as they occur: each search is followed by one in the M-orthogonal
/// complement of what was found, until that finds nothing lower.
class EigenSolver {
 public:
  /// Lower triangles (entries above the diagonal are ignored), in an order that fills in little (as Cholesky takes
  /// them). Rows without mass belong to nothing that moves and have to be decoupled from the others. `threads` is the
  /// most that a factorisation may use. Throws std::invalid_argument for sizes that do not fit or a mass that is zero.
  EigenSolver(const SparseMatrix& stiffness, const SparseMatrix& mass, int threads);

  /// The `count` lowest pairs in ascending order. Throws std::invalid_argument unless 0 < count < the number of rows
  /// with mass; std::runtime_error where the iteration does not converge or no shift makes the matrix definite.
  std::vector<EigenPair> lowest(int count) const;

  /// Rows with mass.
  int size() const { return size_; }

 private:
  class Shifted;
  /// The `count` lowest pairs, ascending, without residuals.
  std::vector<EigenPair> find(int count) const;
  /// The pairs next to -shift among those M-orthogonal to `found`; fewer where the iteration ends too early.
  std::vector<EigenPair> search(const Shifted& inverse, int count, double tolerance,
                                const std::vector<EigenPair>& found) const;
  double residual(const EigenPair& pair, double scale) const;

  SparseMatrix stiffness_, mass_;
  int threads_;
  int size_ = 0;
  double largest_ = 0;  // bound for the largest value: of the diagonals
  Vector start_;        // zero in rows without mass
};

}  // namespace taut
