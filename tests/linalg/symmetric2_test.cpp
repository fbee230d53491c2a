#include "linalg/symmetric2.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "support/random_values.h"

namespace taut {
namespace {

void expect_eigenpairs(double a, double b, double c) {
  const Matrix2 m = (Matrix2() << a, b, b, c).finished();
  const Eigen2 pair = eigen2(a, b, c);
  const double scale = m.norm();
  const Vector2 reference = Eigen::SelfAdjointEigenSolver<Matrix2>(m).eigenvalues();
  EXPECT_GE(pair.values[0], pair.values[1]);
  EXPECT_NEAR(pair.values[0], reference[1], 4e-15 * scale);
  EXPECT_NEAR(pair.values[1], reference[0], 4e-15 * scale);
  EXPECT_NEAR(pair.vectors.determinant(), 1, 1e-15);
  const Matrix2 product =
      pair.vectors * Vector2(pair.values[0], pair.values[1]).asDiagonal() * pair.vectors.transpose();
  EXPECT_LE((product - m).norm(), 4e-15 * scale) << m;
}

TEST(Eigen2, DiagonalisesRandomMatricesOfAllScales) {
  RandomValues random(1);
  for (int sample = 0; sample < 3000; ++sample) {
    const double scale = std::pow(10.0, 12 * random.value());
    expect_eigenpairs(scale * random.value(), scale * random.value(), scale * random.value());
  }
}

TEST(Eigen2, DiagonalisesNearlyIsotropicAndNearlyDiagonalOnes) {
  for (double off : {0.0, 1e-300, 1e-20, 1e-16, 1e-12, 1e-6}) {
    for (double sign : {1.0, -1.0}) {
      expect_eigenpairs(1, sign * off, 1);
      expect_eigenpairs(1, sign * off, 1 + off);
      expect_eigenpairs(1 + off, sign * off, 1);
      expect_eigenpairs(2, sign * off, 1);
      expect_eigenpairs(-1, sign * off, 2);
    }
  }
}

TEST(Eigen2, OfZeroIsZeroWithTheUnitFrame) {
  const Eigen2 pair = eigen2(0, 0, 0);
  EXPECT_EQ(pair.values[0], 0);
  EXPECT_EQ(pair.vectors, Matrix2::Identity());
}

}  // namespace
}  // namespace taut
