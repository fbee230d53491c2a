#include "linalg/symmetric_indefinite.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <numeric>

#include "support/random_values.h"

namespace taut {
namespace {

/// A dense symmetric matrix as the entries of its lower triangle.
struct Specimen {
  Matrix matrix;
  std::vector<int> rows, columns;
  Vector values;

  explicit Specimen(const Matrix& m) : matrix(m), values(m.rows() * (m.rows() + 1) / 2) {
    Index next = 0;
    for (int j = 0; j < m.cols(); ++j) {
      for (int i = j; i < m.rows(); ++i) {
        rows.push_back(i);
        columns.push_back(j);
        values[next++] = m(i, j);
      }
    }
  }
};

Matrix random_symmetric(Index n) {
  const Matrix half = RandomValues(4).matrix(n, n);
  return half + half.transpose();
}

TEST(SymmetricIndefinite, SolvesAndCountsNegativeEigenvalues) {
  const Specimen specimen(random_symmetric(30));
  const Vector eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix>(specimen.matrix).eigenvalues();
  std::vector<int> backwards(30);
  std::iota(backwards.rbegin(), backwards.rend(), 0);
  for (const std::vector<int>& order : {std::vector<int>{}, backwards}) {
    SymmetricIndefinite factor(30, specimen.rows, specimen.columns, order);
    ASSERT_TRUE(factor.factorize(specimen.values));
    EXPECT_EQ(factor.negative_pivots(), (eigenvalues.array() < 0).count());
    const Vector b = RandomValues(5).vector(30);
    Vector x = b;
    factor.solve(x);
    EXPECT_LE((specimen.matrix * x - b).norm(), 1e-9 * b.norm());
  }
}

TEST(SymmetricIndefinite, TakesNewValuesForTheSamePattern) {
  const Specimen specimen(random_symmetric(12));
  SymmetricIndefinite factor(12, specimen.rows, specimen.columns);
  ASSERT_TRUE(factor.factorize(specimen.values));
  const Index negative = factor.negative_pivots();
  ASSERT_TRUE(factor.factorize(-specimen.values));
  EXPECT_EQ(factor.negative_pivots(), 12 - negative);
}

TEST(SymmetricIndefinite, RefusesWhatIsSingularOrNotFinite) {
  Specimen specimen(Matrix::Zero(5, 5));
  SymmetricIndefinite factor(5, specimen.rows, specimen.columns);
  EXPECT_FALSE(factor.factorize(specimen.values));
  specimen.values[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(factor.factorize(specimen.values));
}

TEST(SymmetricIndefinite, TakesAnEmptyMatrix) {
  SymmetricIndefinite factor(0, {}, {});
  Vector nothing;
  EXPECT_TRUE(factor.factorize(nothing));
  factor.solve(nothing);
  EXPECT_EQ(factor.negative_pivots(), 0);
}

}  // namespace
}  // namespace taut
