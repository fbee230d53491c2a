#include "linalg/cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

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
  return result;
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
    Cholesky serial(matrix, 1, 1), parallel(matrix, 1, 2);
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
  SparseMatrix matrix = grid_laplacian(6), full = dense(matrix).sparseView();
  for (int column = 0; column < full.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(full, column); entry; ++entry) {
      if (entry.row() < entry.col()) entry.valueRef() = 1e6;
    }
  }
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
