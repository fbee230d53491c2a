#include "linalg/null_space.h"

#include <Eigen/QR>
#include <cmath>
#include <numeric>
#include <vector>

namespace taut {
namespace {

/// Rows and the columns they touch, through which they hang together.
struct Component {
  std::vector<int> rows, columns;
};

int root_of(std::vector<int>& parent, int i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/// In the order of their first columns; columns that no row touches are components of their own.
std::vector<Component> components_of(const SparseMatrix& rows) {
  std::vector<int> parent(static_cast<std::size_t>(rows.rows()));
  std::iota(parent.begin(), parent.end(), 0);
  for (Index column = 0; column < rows.outerSize(); ++column) {
    int first = -1;
    for (SparseMatrix::InnerIterator entry(rows, column); entry; ++entry) {
      const int root = root_of(parent, static_cast<int>(entry.row()));
      if (first < 0)
        first = root;
      else
        parent[root] = first;
    }
  }
  std::vector<Component> components;
  std::vector<int> component_of(parent.size(), -1);
  for (Index column = 0; column < rows.outerSize(); ++column) {
    const SparseMatrix::InnerIterator entry(rows, column);
    int lonely = -1;
    int& own = entry ? component_of[root_of(parent, static_cast<int>(entry.row()))] : lonely;
    if (own < 0) {
      own = static_cast<int>(components.size());
      components.emplace_back();
    }
    components[own].columns.push_back(static_cast<int>(column));
  }
  for (int row = 0; row < static_cast<int>(parent.size()); ++row) {
    const int own = component_of[root_of(parent, row)];
    if (own >= 0) components[own].rows.push_back(row);
  }
  return components;
}

/// The basis of one component, its columns by (its columns - rank); `place` is scratch, a number per row.
Matrix dense_basis(const SparseMatrix& rows, const Component& component, std::vector<int>& place) {
  const auto m = static_cast<Index>(component.rows.size()), n = static_cast<Index>(component.columns.size());
  if (m == 0) return Matrix::Identity(n, n);
  for (Index i = 0; i < m; ++i) place[component.rows[i]] = static_cast<int>(i);
  Matrix dense = Matrix::Zero(m, n);
  for (Index k = 0; k < n; ++k) {
    for (SparseMatrix::InnerIterator entry(rows, component.columns[k]); entry; ++entry)
      dense(place[entry.row()], k) = entry.value();
  }
  dense.rowwise().normalize();
  Eigen::ColPivHouseholderQR<Matrix> qr(m, n);
  qr.setThreshold(1e-10);
  qr.compute(dense);
  const Index rank = qr.rank();
  if (rank == 0) return Matrix::Identity(n, n);
  if (rank == n) return Matrix(n, 0);  // Eigen solves no empty systems
  Matrix basis(n, n - rank);
  basis.topRows(rank) = -qr.matrixQR()
                             .topLeftCorner(rank, rank)
                             .triangularView<Eigen::Upper>()
                             .solve(qr.matrixQR().topRightCorner(rank, n - rank));
  basis.bottomRows(n - rank).setIdentity();
  return qr.colsPermutation() * basis;
}

}  // namespace

SparseMatrix null_space_basis(const SparseMatrix& rows) {
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<int> place(static_cast<std::size_t>(rows.rows()));
  Index count = 0;
  for (const Component& component : components_of(rows)) {
    const Matrix basis = dense_basis(rows, component, place);
    for (Index k = 0; k < basis.cols(); ++k) {
      for (Index i = 0; i < basis.rows(); ++i) {
        if (std::abs(basis(i, k)) > 1e-14)
          entries.emplace_back(component.columns[i], static_cast<int>(count + k), basis(i, k));
      }
    }
    count += basis.cols();
  }
  SparseMatrix basis(rows.cols(), count);
  basis.setFromTriplets(entries.begin(), entries.end());
  return basis;
}

}  // namespace taut
