#include "constraints/convex_sets.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>

#include "linalg/symmetric2.h"
#include "support/random_values.h"

namespace taut {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Case {
  std::string name;
  std::function<std::shared_ptr<const ConvexSet>()> make;
};

std::vector<Case> cases() {
  return {{"box", [] { return std::make_shared<Box>(3, -0.4, 0.3); }},
          {"orthant", [] { return std::make_shared<Box>(2, 0.0, infinity); }},
          {"point", [] { return std::make_shared<Box>(2, 0.2, 0.2); }},
          {"spectral_box", [] { return std::make_shared<SpectralBox>(-0.2, 0.3); }},
          {"spectral_upper", [] { return std::make_shared<SpectralBox>(-infinity, 0.1); }},
          {"spectral_point", [] { return std::make_shared<SpectralBox>(0.2, 0.2); }}};
}

class EverySet : public testing::TestWithParam<Case> {
 protected:
  const std::shared_ptr<const ConvexSet> set_ = GetParam().make();
  RandomValues random_{1};

  Vector project(const Vector& z) const {
    Vector nearest(z.size());
    set_->project(0, z.data(), nearest.data(), nullptr);
    return nearest;
  }
  Matrix slope(const Vector& z) const {
    Vector nearest(z.size());
    Matrix derivative(z.size(), z.size());
    set_->project(0, z.data(), nearest.data(), derivative.data());
    return derivative;
  }
  Vector any() { return random_.vector(set_->dimension()); }
};

TEST_P(EverySet, ContainsABallWhereItContainsEveryPointOfIt) {
  int contained = 0, almost = 0;
  for (int sample = 0; sample < 300; ++sample) {
    const Vector z = 0.2 * any();
    const double radius = 0.05;
    if (!set_->contains_ball(0, z.data(), radius)) continue;
    ++contained;
    for (int other = 0; other < 10; ++other) {
      const Vector point = z + radius * any().normalized();
      EXPECT_EQ(project(point), point);
    }
    almost += !set_->contains_ball(0, z.data(), 20 * radius);
  }
  const bool thin = GetParam().name.ends_with("point");
  EXPECT_EQ(contained > 0, !thin);
  EXPECT_EQ(almost > 0, !thin && contained > 0);
}

TEST_P(EverySet, ProjectsToTheNearestOfItsPoints) {
  for (int sample = 0; sample < 300; ++sample) {
    const Vector z = any(), nearest = project(z);
    // z - P z makes no acute angle with the way to any other point of the set: that is what nearest means for a convex
    // set.
    for (int other = 0; other < 10; ++other) EXPECT_LE((z - nearest).dot(project(any()) - nearest), 1e-14);
  }
}

TEST_P(EverySet, ProjectsPointsOfTheSetToThemselves) {
  for (int sample = 0; sample < 300; ++sample) {
    const Vector nearest = project(any());
    EXPECT_LE((project(nearest) - nearest).norm(), 1e-15);
  }
}

TEST_P(EverySet, ProjectsFirmlyNonExpansively) {
  for (int sample = 0; sample < 300; ++sample) {
    const Vector a = any(), b = any(), moved = project(a) - project(b);
    EXPECT_LE(moved.squaredNorm(), moved.dot(a - b) + 1e-14);
  }
}

TEST_P(EverySet, HasASymmetricDerivativeBetweenZeroAndOneThatIsTheDifferenceQuotient) {
  const double step = 1e-6;
  int smooth = 0;
  for (int sample = 0; sample < 300; ++sample) {
    const Vector z = any(), direction = any().normalized();
    const Matrix derivative = slope(z);
    EXPECT_LE((derivative - derivative.transpose()).norm(), 1e-15);
    const Vector eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix>(derivative).eigenvalues();
    EXPECT_GE(eigenvalues.minCoeff(), -1e-14);
    EXPECT_LE(eigenvalues.maxCoeff(), 1 + 1e-14);
    // At a kink the derivatives on both sides differ by more than the step explains.
    const Vector ahead = z + step * direction, behind = z - step * direction;
    if ((slope(ahead) - slope(behind)).norm() > 1e3 * step) continue;
    ++smooth;
    EXPECT_LE((derivative * direction - (project(ahead) - project(behind)) / (2 * step)).norm(), 1e-8);
  }
  EXPECT_GT(smooth, 250);
}

TEST_P(EverySet, HasASmoothedProjectionWithinTheWidthOfTheTrueOneWhoseDerivativeIsTheDifferenceQuotient) {
  for (double width : {0.1, 1e-2, 1e-3}) {
    const double step = 1e-4 * width;
    const auto smoothed = [&](const Vector& z, Matrix& derivative) {
      Vector nearest(z.size()), rate(z.size());
      Matrix inverse(z.size(), z.size());
      set_->project_smoothed(0, z.data(), width * width, nearest.data(), inverse.data(), rate.data());
      EXPECT_LE((inverse - inverse.transpose()).norm(), 1e-14 * inverse.norm());
      derivative = inverse.inverse();
      return nearest;
    };
    const auto at_epsilon = [&](const Vector& z, double epsilon, Vector& rate) {
      Vector nearest(z.size());
      Matrix inverse(z.size(), z.size());
      rate.resize(z.size());
      set_->project_smoothed(0, z.data(), epsilon, nearest.data(), inverse.data(), rate.data());
      return nearest;
    };
    for (int sample = 0; sample < 200; ++sample) {
      const Vector z = any(), direction = any().normalized();
      Matrix derivative, elsewhere;
      const Vector nearest = smoothed(z, derivative);
      EXPECT_LE((nearest - project(z)).norm(), 1.01 * width * std::sqrt(static_cast<double>(z.size())));
      const Vector eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix>(derivative).eigenvalues();
      EXPECT_GT(eigenvalues.minCoeff(), 0);
      EXPECT_LE(eigenvalues.maxCoeff(), 1 + 1e-12);
      const Vector ahead = smoothed(z + step * direction, elsewhere),
                   behind = smoothed(z - step * direction, elsewhere);
      EXPECT_LE((derivative * direction - (ahead - behind) / (2 * step)).norm(), 1e-7) << width;
      Vector rate, unused;
      const double epsilon = width * width, change = 1e-4 * epsilon, round_off = 1e-15;
      at_epsilon(z, epsilon, rate);
      const Vector difference = at_epsilon(z, epsilon + change, unused) - at_epsilon(z, epsilon - change, unused);
      EXPECT_LE((rate - difference / (2 * change)).norm(), 1e-6 * rate.norm() + round_off / change) << width;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, EverySet, testing::ValuesIn(cases()), [](const auto& set) { return set.param.name; });

TEST(SpectralBox, ClampsEigenvaluesInTheirFrame) {
  RandomValues random(2);
  const SpectralBox box(0.5, 1.5);
  for (int sample = 0; sample < 300; ++sample) {
    Vector3 z = Vector3(1, 0, 1), nearest;
    for (double& entry : z) entry += 2 * random.value();
    box.project(0, z.data(), nearest.data(), nullptr);
    const Eigen2 from = eigen2(z[0], z[1] / std::numbers::sqrt2, z[2]);
    const Matrix2 expected =
        from.vectors *
        Vector2(std::clamp(from.values[0], 0.5, 1.5), std::clamp(from.values[1], 0.5, 1.5)).asDiagonal() *
        from.vectors.transpose();
    EXPECT_NEAR(nearest[0], expected(0, 0), 1e-14);
    EXPECT_NEAR(nearest[1], std::numbers::sqrt2 * expected(0, 1), 1e-14);
    EXPECT_NEAR(nearest[2], expected(1, 1), 1e-14);
  }
}

TEST(SpectralBox, IsSmoothThroughCoincidentEigenvalues) {
  const SpectralBox box(-infinity, 1.0);
  Vector3 nearest;
  Matrix3 at, beside;
  for (double value : {0.5, 2.0}) {
    for (double gap : {1e-16, 1e-15, 1e-13, 1e-10, 1e-7}) {
      const Vector3 z(value, 0, value), moved(value + gap, gap, value - gap);
      box.project(0, z.data(), nearest.data(), at.data());
      box.project(0, moved.data(), nearest.data(), beside.data());
      EXPECT_LE((at - beside).norm(), 1e-12) << value << " " << gap;
    }
  }
}

TEST(ConvexSets, PassNanOn) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Case& c : cases()) {
    const auto set = c.make();
    Vector z = Vector::Zero(set->dimension()), nearest = z;
    z[0] = nan;
    set->project(0, z.data(), nearest.data(), nullptr);
    EXPECT_FALSE(nearest.allFinite()) << c.name;
  }
}

TEST(ConvexSets, RejectBoundsTheWrongWayRound) {
  EXPECT_THROW(Box(1, 1, 0), std::invalid_argument);
  EXPECT_THROW(SpectralBox(1, 0), std::invalid_argument);
  EXPECT_THROW(Box(1, std::nan(""), 1), std::invalid_argument);
}

}  // namespace
}  // namespace taut
