#include "linalg/null_space.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseQR>
#include <cmath>
#include <vector>

namespace taut {

SparseMatrix null_space_basis(const SparseMatrix& rows) {
  const Index n = rows.cols();
  SparseMatrix basis(n, n);
  if (rows.rows() == 0) {
    basis.setIdentity();
    return basis;
  }
  const Eigen::SparseQR<SparseMatrix, Eigen::COLAMDOrdering<int>> qr(rows);
  const Index rank = qr.rank();
  const SparseMatrix r = SparseMatrix(qr.matrixR()).topRows(rank);
  const auto permutation = qr.colsPermutation().indices();
  const SparseMatrix basic = r.leftCols(rank);
  Eigen::MatrixXd column;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index k = 0; k + rank < n; ++k) {
    column = r.col(rank + k);
    if (rank > 0) column = basic.triangularView<Eigen::Upper>().solve(column);
    for (Index i = 0; i < rank; ++i) {
      if (std::abs(column(i, 0)) > 1e-14) {
        entries.emplace_back(static_cast<int>(permutation[i]), static_cast<int>(k), -column(i, 0));
      }
    }
    entries.emplace_back(static_cast<int>(permutation[rank + k]), static_cast<int>(k), 1.0);
  }
  basis.resize(n, n - rank);
  basis.setFromTriplets(entries.begin(), entries.end());
  return basis;
}

}  // namespace taut
