#include "linalg/cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "support/random_values.h"

namespace taut {
namespace {

/// The 5-point Laplacian of an n x n grid plus the identity, lower triangle, with `extra` added to the last diagonal
/// entry.
SparseMatrix grid_laplacian(int n, double extra = 0) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto id = [n](int i, int j) { return j * n + i; };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      entries.emplace_back(id(i, j), id(i, j), 5.0);
      if (i + 1 < n) entries.emplace_back(id(i + 1, j), id(i, j), -1.0);
      if (j + 1 < n) entries.emplace_back(id(i, j + 1), id(i, j), -1.0);
    }
  }
  entries.emplace_back(n * n - 1, n * n - 1, extra);
  SparseMatrix matrix(n * n, n * n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Matrix dense(const SparseMatrix& lower) { return Matrix(lower).selfadjointView<Eigen::Lower>(); }

/// The lower triangle, with something else above it.
SparseMatrix with_nonsense_above(const SparseMatrix& lower) {
  SparseMatrix full = lower.selfadjointView<Eigen::Lower>();
  for (int column = 0; column < full.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(full, column); entry; ++entry) {
      if (entry.row() < entry.col()) entry.valueRef() = 1e6;
    }
  }
  return full;
}

GroupGraph grid_graph(int n) {
  GroupGraph graph;
  graph.starts = {0};
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      if (j > 0) graph.neighbours.push_back((j - 1) * n + i);
      if (i > 0) graph.neighbours.push_back(j * n + i - 1);
      if (i + 1 < n) graph.neighbours.push_back(j * n + i + 1);
      if (j + 1 < n) graph.neighbours.push_back((j + 1) * n + i);
      graph.starts.push_back(static_cast<int>(graph.neighbours.size()));
    }
  }
  return graph;
}

SparseMatrix permuted(const SparseMatrix& lower, const std::vector<int>& order) {
  Eigen::PermutationMatrix<Eigen::Dynamic> place(lower.rows());
  for (int k = 0; k < static_cast<int>(order.size()); ++k) place.indices()[order[static_cast<std::size_t>(k)]] = k;
  SparseMatrix result(lower.rows(), lower.cols());
  result.selfadjointView<Eigen::Lower>() = lower.selfadjointView<Eigen::Lower>().twistedBy(place);
  const SparseMatrix sorted = result.transpose();
  return sorted.transpose();
}

/// A few matrices of at least 40,000 rows, which two threads factorise by subtrees: a grid in nested dissection, the
/// same in its natural order (one chain), lone grids (a forest), a path, and rows that nothing couples.
std::vector<std::pair<std::string, SparseMatrix>> large_matrices() {
  const auto dissected = [](int n) { return permuted(grid_laplacian(n), fill_reducing_order(grid_graph(n))); };
  std::vector<Eigen::Triplet<double>> forest, path, diagonal;
  const SparseMatrix tree = dissected(110);
  for (int copy = 0; copy < 4; ++copy) {
    for (int column = 0; column < tree.cols(); ++column) {
      const int first = copy * static_cast<int>(tree.cols());
      for (SparseMatrix::InnerIterator entry(tree, column); entry; ++entry)
        forest.emplace_back(first + static_cast<int>(entry.row()), first + column, entry.value());
    }
  }
  for (int i = 0; i < 40000; ++i) {
    diagonal.emplace_back(i, i, 5.0);
    path.emplace_back(i, i, 5.0);
    if (i + 1 < 40000) path.emplace_back(i + 1, i, -1.0);
  }
  const auto matrix = [](int n, const auto& entries) {
    SparseMatrix lower(n, n);
    lower.setFromTriplets(entries.begin(), entries.end());
    return lower;
  };
  return {{"dissected", dissected(200)},
          {"chain", grid_laplacian(200)},
          {"forest", matrix(4 * static_cast<int>(tree.rows()), forest)},
          {"path", matrix(40000, path)},
          {"diagonal", matrix(40000, diagonal)}};
}

TEST(CholeskyOnTwoThreads, SolvesAsOnOneAndGivesTheSameBitsTwice) {
  for (const auto& [name, lower] : large_matrices()) {
    const SparseMatrix matrix = with_nonsense_above(lower);
    Cholesky one(matrix, 1), two(matrix, 2), again(matrix, 2);
    const Vector b = RandomValues(1).vector(matrix.rows());
    ASSERT_TRUE(again.factorize(3 * matrix));
    Vector expected, x, y;
    again.solve(b, y);
    const std::size_t bytes = again.memory_bytes();
    for (const double shift : {0.0, 2.5}) {
      ASSERT_TRUE(one.factorize(matrix, shift)) << name;
      ASSERT_TRUE(two.factorize(matrix, shift)) << name;
      ASSERT_TRUE(again.factorize(matrix, shift)) << name;
      one.solve(b, expected);
      two.solve(b, x);
      again.solve(b, y);
      EXPECT_EQ(x, y) << name;
      EXPECT_LE((x - expected).norm(), 1e-14 * expected.norm()) << name;
      const Vector residual = lower.selfadjointView<Eigen::Lower>() * x + shift * x - b;
      EXPECT_LE(residual.norm(), 1e-14 * b.norm()) << name;
      two.solve_roughly(b, x);
      EXPECT_LE((x - expected).norm(), 1e-6 * expected.norm()) << name;
    }
    EXPECT_EQ(again.memory_bytes(), bytes) << name;
  }
}

/// The rows are in either share and above both.
TEST(CholeskyOnTwoThreads, SaysWhereAMatrixIsNotPositiveDefiniteOrNotFiniteAndRecovers) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const auto& [name, good] : large_matrices()) {
    Cholesky one(good, 1), two(good, 2);
    const Index n = good.rows();
    const Vector b = RandomValues(1).vector(n);
    ASSERT_TRUE(one.factorize(good));
    Vector x, expected;
    one.solve(b, expected);
    for (const Index row : {Index{0}, n / 4, n / 2, 3 * n / 4, n - 1}) {
      for (const double value : {-6.0, 0.0, nan, infinity}) {
        SparseMatrix bad = good;
        bad.coeffRef(row, row) = value;
        EXPECT_FALSE(two.factorize(bad)) << name << " row " << row << " " << value;
      }
    }
    EXPECT_FALSE(two.factorize(good, -20.0)) << name;
    EXPECT_FALSE(two.factorize(good, nan)) << name;
    EXPECT_FALSE(two.factorize(0 * good)) << name;
    ASSERT_TRUE(two.factorize(good)) << name;
    two.solve(b, x);
    EXPECT_LE((x - expected).norm(), 1e-14 * expected.norm()) << name;
  }
}

TEST(Cholesky, SolvesRoughlyToSinglePrecisionWithTheLastFactor) {
  for (int n : {1, 2, 7, 20}) {
    Cholesky cholesky(grid_laplacian(n), 1);
    const Vector b = RandomValues(1).vector(n * n);
    for (const double extra : {0.0, 3.0}) {
      const SparseMatrix matrix = grid_laplacian(n, extra);
      ASSERT_TRUE(cholesky.factorize(matrix));
      Vector x = b;
      cholesky.solve_roughly(x, x);
      EXPECT_LE((x - dense(matrix).llt().solve(b)).norm(), 1e-6 * x.norm()) << n << ", " << extra;
    }
  }
}

/// A nested-dissection order has subtrees to share out; the natural order of a grid is one chain.
TEST(Cholesky, SolvesRoughlyToTheSameBitsWithTwoThreads) {
  constexpr int n = 40;
  for (const bool dissected : {true, false}) {
    SparseMatrix matrix = grid_laplacian(n);
    if (dissected) matrix = permuted(matrix, fill_reducing_order(grid_graph(n)));
    const Vector b = RandomValues(1).vector(n * n);
    Cholesky serial(matrix, 1), parallel(matrix, 2);
    ASSERT_TRUE(serial.factorize(matrix));
    ASSERT_TRUE(parallel.factorize(matrix));
    Vector exact, one, two;
    serial.solve(b, exact);
    serial.solve_roughly(b, one);
    EXPECT_LE((one - exact).norm(), 1e-6 * exact.norm());
    for (const char* time : {"first", "second"}) {
      parallel.solve_roughly(b, two);
      EXPECT_EQ(one, two) << time;
    }
  }
}

TEST(Cholesky, SolvesAsADenseFactorDoes) {
  for (int n : {1, 2, 7, 20}) {
    const SparseMatrix matrix = grid_laplacian(n);
    Cholesky cholesky(matrix, 1);
    ASSERT_TRUE(cholesky.factorize(matrix));
    const Vector b = RandomValues(1).vector(n * n);
    Vector x;
    cholesky.solve(b, x);
    EXPECT_LE((x - dense(matrix).llt().solve(b)).norm(), 1e-13 * x.norm());
  }
}

TEST(Cholesky, SolvesInPlace) {
  const SparseMatrix matrix = grid_laplacian(9);
  Cholesky cholesky(matrix, 1);
  ASSERT_TRUE(cholesky.factorize(matrix));
  const Vector b = RandomValues(1).vector(81);
  Vector x = b, apart;
  cholesky.solve(x, x);
  cholesky.solve(b, apart);
  EXPECT_EQ(x, apart);
}

TEST(Cholesky, AddsTheShiftToTheDiagonal) {
  const SparseMatrix matrix = grid_laplacian(6);
  Cholesky cholesky(matrix, 1);
  ASSERT_TRUE(cholesky.factorize(matrix, 2.5));
  const Vector b = RandomValues(1).vector(36);
  Vector x;
  cholesky.solve(b, x);
  EXPECT_LE((dense(matrix) * x + 2.5 * x - b).norm(), 1e-13);
}

TEST(Cholesky, IgnoresEntriesAboveTheDiagonal) {
  const SparseMatrix matrix = grid_laplacian(6), full = with_nonsense_above(matrix);
  Cholesky cholesky(full, 1);
  ASSERT_TRUE(cholesky.factorize(full));
  const Vector b = RandomValues(1).vector(36);
  Vector x;
  cholesky.solve(b, x);
  EXPECT_LE((dense(matrix) * x - b).norm(), 1e-13);
}

TEST(Cholesky, SaysWhereAMatrixIsNotPositiveDefiniteAndRecovers) {
  for (int n : {2, 6, 20}) {
    const SparseMatrix good = grid_laplacian(n), bad = grid_laplacian(n, -6.0), flipped = -good;
    Cholesky cholesky(good, 1);
    EXPECT_FALSE(cholesky.factorize(bad)) << n;
    EXPECT_FALSE(cholesky.factorize(flipped)) << n;
    EXPECT_FALSE(cholesky.factorize(0 * good)) << n;
    EXPECT_FALSE(cholesky.factorize(good, -20.0)) << n;
    EXPECT_TRUE(cholesky.factorize(bad, 10.0)) << n;
    ASSERT_TRUE(cholesky.factorize(good)) << n;
    const Vector b = RandomValues(1).vector(n * n);
    Vector x;
    cholesky.solve(b, x);
    EXPECT_LE((dense(good) * x - b).norm(), 1e-12);
  }
}

TEST(Cholesky, SaysWhereAnEntryIsNotFinite) {
  for (int n : {2, 6, 20}) {
    const SparseMatrix good = grid_laplacian(n);
    Cholesky cholesky(good, 1);
    for (double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      for (Index entry : {Index{0}, Index{1}, good.nonZeros() / 2, good.nonZeros() - 1}) {
        SparseMatrix bad = good;
        bad.valuePtr()[entry] = value;
        EXPECT_FALSE(cholesky.factorize(bad)) << n << " " << value << " entry " << entry;
      }
    }
    EXPECT_TRUE(cholesky.factorize(good));
  }
}

TEST(Cholesky, FactorisesAgainIntoTheSameMemory) {
  const SparseMatrix matrix = grid_laplacian(20);
  Cholesky cholesky(matrix, 1);
  Vector b = RandomValues(1).vector(400), x;
  ASSERT_TRUE(cholesky.factorize(matrix));
  cholesky.solve(b, x);
  const std::size_t bytes = cholesky.memory_bytes();
  for (int repeat = 0; repeat < 5; ++repeat) {
    const SparseMatrix scaled = (2.0 + repeat) * matrix;
    ASSERT_TRUE(cholesky.factorize(scaled));
    EXPECT_FALSE(cholesky.factorize(-scaled));
    ASSERT_TRUE(cholesky.factorize(scaled, 0.5));
    cholesky.solve(b, x);
    EXPECT_EQ(cholesky.memory_bytes(), bytes);
  }
}

TEST(Cholesky, GivesTheSameBitsTwice) {
  const SparseMatrix matrix = grid_laplacian(20);
  const Vector b = RandomValues(1).vector(400);
  Vector x, y;
  Cholesky first(matrix, 1), second(matrix, 1);
  ASSERT_TRUE(first.factorize(matrix));
  ASSERT_TRUE(second.factorize(3 * matrix));
  ASSERT_TRUE(second.factorize(matrix));
  first.solve(b, x);
  second.solve(b, y);
  EXPECT_EQ(x, y);
}

TEST(Cholesky, TakesAMatrixWithoutRows) {
  const SparseMatrix nothing(0, 0);
  Cholesky cholesky(nothing, 1);
  EXPECT_TRUE(cholesky.factorize(nothing));
  Vector x;
  cholesky.solve(Vector(0), x);
  EXPECT_EQ(x.size(), 0);
}

TEST(FillReducingOrder, IsAPermutationAndTheSameTwice) {
  for (int n : {1, 2, 5, 30}) {
    const std::vector<int> order = fill_reducing_order(grid_graph(n));
    EXPECT_EQ(order, fill_reducing_order(grid_graph(n)));
    std::vector<int> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    for (int i = 0; i < n * n; ++i) EXPECT_EQ(sorted[static_cast<std::size_t>(i)], i);
  }
}

TEST(FillReducingOrder, OfNothingAndOfLoneNodes) {
  GroupGraph graph;
  graph.starts = {0};
  EXPECT_TRUE(fill_reducing_order(graph).empty());
  graph.starts = {0, 0, 0, 0};
  EXPECT_EQ(fill_reducing_order(graph).size(), 3u);
}

TEST(FillReducingOrder, FillsLessThanTheNaturalOrder) {
  const int n = 40;
  const std::vector<int> order = fill_reducing_order(grid_graph(n));
  const SparseMatrix natural = grid_laplacian(n), ordered = permuted(natural, order);
  EXPECT_LT(Cholesky(ordered, 1).factor_nonzeros(), 0.6 * Cholesky(natural, 1).factor_nonzeros());
}

}  // namespace
}  // namespace taut
