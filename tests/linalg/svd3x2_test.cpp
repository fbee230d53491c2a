#include "linalg/svd3x2.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>

#include "support/random_values.h"

namespace taut {
namespace {

constexpr double round_off = 2e-14;

/// Everything that svd() promises, measured relative to d1.
void expect_svd(const Matrix32& f) {
  const Svd32 s = svd(f);
  const Vector2 reference = Eigen::JacobiSVD<Matrix32>(f).singularValues();
  const double scale = reference[0];
  EXPECT_NEAR(s.d1, reference[0], round_off * scale) << f;
  EXPECT_NEAR(s.d2, reference[1], round_off * scale) << f;
  EXPECT_LE((singular_values(f) - reference).norm(), round_off * scale) << f;
  EXPECT_GE(s.d1, s.d2 - round_off * scale);
  EXPECT_GE(s.d2, 0);
  const Matrix32 product = s.d1 * s.u1 * s.v1.transpose() + s.d2 * s.u2 * s.v2.transpose();
  EXPECT_LE((product - f).norm(), round_off * scale) << f;
  Matrix3 left;
  left << s.u1, s.u2, s.n;
  EXPECT_LE((left.transpose() * left - Matrix3::Identity()).norm(), round_off) << f;
  EXPECT_GT(left.determinant(), 0) << f;
  EXPECT_NEAR(s.v1.squaredNorm(), 1, round_off);
  EXPECT_NEAR(s.v1.x() * s.v2.y() - s.v1.y() * s.v2.x(), 1, round_off);
}

TEST(Svd3x2, AgreesWithJacobiOnRandomMatricesOfAllScales) {
  RandomValues random(1);
  for (int sample = 0; sample < 3000; ++sample) {
    const double scale = std::pow(10.0, 6 * random.value());
    expect_svd(scale * Matrix32(random.matrix(3, 2)));
  }
}

TEST(Svd3x2, AgreesWithJacobiWhereSingularValuesMeetOrVanish) {
  RandomValues random(2);
  for (double d2 : {1.0, 1 - 1e-15, 1 - 1e-12, 1 - 1e-8, 1 - 1e-4, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 0.0}) {
    for (int sample = 0; sample < 300; ++sample) {
      const Matrix3 u = random.rotation();
      const Matrix2 v = Eigen::Rotation2Dd(3 * random.value()).toRotationMatrix();
      const double scale = std::pow(10.0, 6 * random.value());
      expect_svd(scale * u.leftCols<2>() * Vector2(1, d2).asDiagonal() * v.transpose());
    }
  }
}

TEST(Svd3x2, HasAnOrthonormalFrameForParallelColumnsOfSmallNumbers) {
  // Products of small integers and thirds make the area vector exactly zero, or pure round-off in any direction.
  for (int a = -3; a <= 3; ++a) {
    for (int b = -3; b <= 3; ++b) {
      for (int c = 0; c <= 3; ++c) {
        for (double factor : {0.0, 1.0, -2.0, 1.0 / 3, 0.1, 1e-9}) {
          Matrix32 f;
          f.col(0) = Vector3(a, b / 3.0, c * 1e-9);
          f.col(1) = factor * f.col(0);
          if (f.norm() > 0) expect_svd(f);
        }
      }
    }
  }
}

TEST(Svd3x2, OfZeroHasAFrameAllTheSame) {
  const Svd32 s = svd(Matrix32::Zero());
  EXPECT_EQ(s.d1, 0);
  EXPECT_EQ(s.d2, 0);
  EXPECT_EQ(s.u1.cross(s.u2), s.n);
}

TEST(Svd3x2, OfANanIsNan) {
  Matrix32 f = Matrix32::Identity();
  f(2, 1) = std::nan("");
  EXPECT_FALSE(singular_values(f).allFinite());
}

}  // namespace
}  // namespace taut
