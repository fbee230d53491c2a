#include <Eigen/QR>
#include <algorithm>
#include <set>

#include "geometry/prolongation.h"

namespace taut {
namespace {

using Column = std::vector<std::pair<int, double>>;  // fine point and entry

/// Builds the columns of C, the right inverse of P^T.
class RightInverse {
 public:
  RightInverse(const TriangleMesh& coarse, const Prolongation& prolongation)
      : coarse_(coarse),
        anchors_(prolongation.anchors),
        rows_(prolongation.weights),
        points_in_(coarse.triangles.size()),
        triangles_at_(coarse.vertices.size()),
        coincident_(coarse.vertices.size(), -1) {
    for (std::size_t i = 0; i < anchors_.size(); ++i) {
      points_in_[static_cast<std::size_t>(anchors_[i].triangle)].push_back(static_cast<int>(i));
      for (int k = 0; k < 3; ++k) {
        int& own = coincident_[coarse.triangles[static_cast<std::size_t>(anchors_[i].triangle)][k]];
        if (anchors_[i].weights[k] == 1 && own < 0) own = static_cast<int>(i);
      }
    }
    for (std::size_t t = 0; t < coarse.triangles.size(); ++t) {
      for (const int vertex : coarse.triangles[t]) triangles_at_[vertex].push_back(static_cast<int>(t));
    }
  }

  /// Empty where P is rank deficient.
  Column column(int vertex) const {
    if (coincident_[vertex] >= 0) return {{coincident_[vertex], 1.0}};
    for (const int triangle : triangles_at_[vertex]) {
      const Column found = in_triangle(triangle, vertex);
      if (!found.empty()) return found;
    }
    return on_patch(vertex);
  }

 private:
  /// Three points of the triangle that span its corners well, chosen by a QR factorisation with pivots.
  Column in_triangle(int triangle, int vertex) const {
    const std::vector<int>& points = points_in_[static_cast<std::size_t>(triangle)];
    if (points.size() < 3) return {};
    Matrix weights(3, static_cast<Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) weights.col(static_cast<Index>(i)) = anchors_[points[i]].weights;
    const Eigen::ColPivHouseholderQR<Matrix> qr(weights);
    if (std::abs(qr.matrixQR()(2, 2)) < 1e-2 * std::abs(qr.matrixQR()(0, 0))) return {};
    Matrix3 chosen;
    Column column;
    for (int i = 0; i < 3; ++i) {
      const Index at = qr.colsPermutation().indices()[i];
      chosen.col(i) = weights.col(at);
      column.emplace_back(points[static_cast<std::size_t>(at)], 0.0);
    }
    const Triangle& corners = coarse_.triangles[static_cast<std::size_t>(triangle)];
    const auto corner = std::find(corners.begin(), corners.end(), vertex) - corners.begin();
    const Vector3 entries = chosen.partialPivLu().solve(Vector3::Unit(static_cast<int>(corner)));
    for (int i = 0; i < 3; ++i) column[i].second = entries[i];
    return column;
  }

  /// The least-norm solution of P^T c = e_vertex on the points of the triangles around, ring by ring.
  Column on_patch(int vertex) const {
    std::set<int> triangles(triangles_at_[vertex].begin(), triangles_at_[vertex].end());
    for (std::size_t before = 0; before != triangles.size();) {
      const Column found = least_norm(triangles, vertex);
      if (!found.empty()) return found;
      before = triangles.size();
      std::set<int> vertices;
      for (const int t : triangles) vertices.insert(coarse_.triangles[t].begin(), coarse_.triangles[t].end());
      for (const int v : vertices) triangles.insert(triangles_at_[v].begin(), triangles_at_[v].end());
    }
    return {};
  }

  Column least_norm(const std::set<int>& triangles, int vertex) const {
    std::vector<int> points, vertices;
    for (const int t : triangles) {
      points.insert(points.end(), points_in_[static_cast<std::size_t>(t)].begin(),
                    points_in_[static_cast<std::size_t>(t)].end());
      vertices.insert(vertices.end(), coarse_.triangles[t].begin(), coarse_.triangles[t].end());
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    const auto row_of = [&](int v) { return std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin(); };
    if (points.empty()) return {};
    Matrix weights = Matrix::Zero(static_cast<Index>(vertices.size()), static_cast<Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (SparseMatrix::InnerIterator entry(rows_, points[i]); entry; ++entry)
        weights(row_of(static_cast<int>(entry.row())), static_cast<Index>(i)) = entry.value();
    }
    const Vector unit = Vector::Unit(static_cast<Index>(vertices.size()), row_of(vertex));
    const Vector entries = weights.completeOrthogonalDecomposition().solve(unit);
    if (!((weights * entries - unit).lpNorm<Eigen::Infinity>() < 1e-11)) return {};
    Column column;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (entries[static_cast<Index>(i)] != 0) column.emplace_back(points[i], entries[static_cast<Index>(i)]);
    }
    return column;
  }

  const TriangleMesh& coarse_;
  const std::vector<Anchor>& anchors_;
  SparseMatrix rows_;  // P^T: the weights of a point are a column
  std::vector<std::vector<int>> points_in_, triangles_at_;
  std::vector<int> coincident_;
};

/// One row for each column of C such that these rows of C form a regular matrix.
std::vector<char> pivot_rows(const SparseMatrix& c) {
  std::vector<char> chosen(static_cast<std::size_t>(c.rows()), 0);
  std::vector<Index> hard;  // columns without a point of their own
  for (Index k = 0; k < c.cols(); ++k) {
    const SparseMatrix::InnerIterator entry(c, k);
    if (c.col(k).nonZeros() == 1) {
      chosen[static_cast<std::size_t>(entry.row())] = 1;
    } else {
      hard.push_back(k);
    }
  }
  if (hard.empty()) return chosen;
  std::vector<int> rows;
  for (const Index k : hard) {
    for (SparseMatrix::InnerIterator entry(c, k); entry; ++entry) {
      if (!chosen[static_cast<std::size_t>(entry.row())]) rows.push_back(static_cast<int>(entry.row()));
    }
  }
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  Matrix transposed = Matrix::Zero(static_cast<Index>(hard.size()), static_cast<Index>(rows.size()));
  for (std::size_t k = 0; k < hard.size(); ++k) {
    for (SparseMatrix::InnerIterator entry(c, hard[k]); entry; ++entry) {
      const auto at = std::lower_bound(rows.begin(), rows.end(), static_cast<int>(entry.row()));
      if (at != rows.end() && *at == entry.row()) transposed(static_cast<Index>(k), at - rows.begin()) = entry.value();
    }
  }
  const Eigen::ColPivHouseholderQR<Matrix> qr(transposed);
  for (std::size_t i = 0; i < hard.size(); ++i)
    chosen[static_cast<std::size_t>(
        rows[static_cast<std::size_t>(qr.colsPermutation().indices()[static_cast<Index>(i)])])] = 1;
  return chosen;
}

}  // namespace

SparseMatrix right_inverse(const TriangleMesh& coarse, const Prolongation& prolongation, const std::string& label) {
  Prolongation transposed{SparseMatrix(prolongation.weights.transpose()), prolongation.anchors};
  const RightInverse inverse(coarse, transposed);
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < static_cast<int>(coarse.vertices.size()); ++k) {
    const Column column = inverse.column(k);
    if (column.empty())
      throw MeshError(label + ": its points cannot tell the motion of vertex " + std::to_string(k) +
                      " of the coarse mesh from that of its neighbours (P is rank deficient); refine it there");
    for (const auto& [point, value] : column) entries.emplace_back(point, k, value);
  }
  SparseMatrix c(prolongation.weights.rows(), prolongation.weights.cols());
  c.setFromTriplets(entries.begin(), entries.end());
  return c;
}

SparseMatrix complementary_basis(const TriangleMesh& coarse, const Prolongation& prolongation,
                                 const std::string& label) {
  const SparseMatrix c = right_inverse(coarse, prolongation, label);
  const std::vector<char> pivots = pivot_rows(c);
  SparseMatrix units(c.rows(), c.rows() - c.cols());
  Index column = 0;
  for (Index i = 0; i < c.rows(); ++i) {
    if (!pivots[static_cast<std::size_t>(i)]) units.insert(i, column++) = 1;
  }
  units.makeCompressed();
  const SparseMatrix seen = prolongation.weights.transpose() * units;
  SparseMatrix basis = units - SparseMatrix(c * seen);
  basis.prune([](Index, Index, double value) { return value != 0; });
  return basis;
}

}  // namespace taut
