#include "linalg/null_space.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "support/random_values.h"

namespace taut {
namespace {

void expect_basis(const Matrix& rows, Index rank) {
  const Matrix basis = null_space_basis(rows.sparseView());
  ASSERT_EQ(basis.rows(), rows.cols());
  ASSERT_EQ(basis.cols(), rows.cols() - rank);
  if (basis.size() == 0) return;
  EXPECT_LE((rows * basis).lpNorm<Eigen::Infinity>(), 1e-12 * rows.lpNorm<Eigen::Infinity>());
  const Vector singular = Eigen::JacobiSVD<Matrix>(basis).singularValues();
  EXPECT_GE(singular.minCoeff(), 1 - 1e-12);  // there is an identity in it
}

TEST(NullSpaceBasis, FindsTheRankOfDependentRows) {
  // Many more rows than their rank: round-off of the first ones eliminated, which a sparse QR that pivots within its
  // order only takes for rank.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const Index rank : {1, 23, 40}) {
      RandomValues random(seed);
      const Matrix basis = random.matrix(rank, 60);
      expect_basis(random.matrix(160, rank) * basis, rank);
    }
  }
}

TEST(NullSpaceBasis, TakesSparseRowsOfDifferentSizesApart) {
  Matrix rows = Matrix::Zero(40, 120);
  const Vector values = RandomValues(5).vector(40 * 5);
  for (Index i = 0; i < 40; ++i) {
    for (Index k = 0; k < 5; ++k) rows(i, (7 * i + 11 * k) % 60) = values[5 * i + k];
  }
  for (Index i = 30; i < 40; ++i) rows.row(i) = 1e5 * rows.row(i - 10) - rows.row(i - 20);
  expect_basis(rows, Eigen::FullPivLU<Matrix>(rows).setThreshold(1e-11).rank());
}

TEST(NullSpaceBasis, TakesRowsThatFixSingleColumns) {
  Matrix rows = Matrix::Zero(3, 6);
  rows(0, 4) = rows(1, 1) = rows(2, 4) = 2;  // one of them twice
  expect_basis(rows, 2);
  const SparseMatrix basis = null_space_basis(rows.sparseView());
  EXPECT_EQ(basis.nonZeros(), 4);
}

TEST(NullSpaceBasis, TakesNoRowsAndRowsOfZeros) {
  expect_basis(Matrix::Zero(0, 4), 0);
  expect_basis(Matrix::Zero(2, 4), 0);
}

TEST(NullSpaceBasis, IsEmptyWhereTheRowsDecideEverything) { expect_basis(RandomValues(6).matrix(8, 5), 5); }

}  // namespace
}  // namespace taut
