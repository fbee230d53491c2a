#include "constraints/obstacle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace taut {
namespace {

TEST(HalfSpace, GapIsTheDistanceAlongAUnitNormal) {
  HalfSpace floor("floor", "cloth", {4, 5}, 4, 2.0);
  floor.place({0, 0, 1}, {0, 3, 4});
  const Vector3 x(7, 1, 2);
  Vector3 jacobian;
  double gap;
  floor.evaluate(0, x.data(), &gap, jacobian.data());
  EXPECT_DOUBLE_EQ(gap, 0.6 * 1 + 0.8 * 1);
  EXPECT_LE((jacobian - Vector3(0, 0.6, 0.8)).norm(), 1e-16);
  EXPECT_EQ(floor.violation(0, x.data()), 0);
  EXPECT_EQ(floor.element_name(1), "vertex 1 of cloth");
  EXPECT_EQ(floor.violation_scale(), 2.0);
}

TEST(HalfSpace, ViolationIsThePenetration) {
  HalfSpace floor("floor", "cloth", {0}, 0, 1.0);
  floor.place({0, 0, 0}, {0, 0, 2});
  const Vector3 below(0, 0, -0.25), broken(0, 0, std::nan(""));
  EXPECT_DOUBLE_EQ(floor.violation(0, below.data()), 0.25);
  EXPECT_TRUE(std::isnan(floor.violation(0, broken.data())));
}

TEST(SphereObstacle, GapIsTheDistanceFromItsSurface) {
  SphereObstacle ball("ball", "cloth", {0}, 0, 1.0, 2.0);
  ball.place({1, 0, 0});
  const Vector3 outside(1, 3, 4), inside(1, 0, 0.5);
  Vector3 jacobian;
  double gap;
  ball.evaluate(0, outside.data(), &gap, jacobian.data());
  EXPECT_DOUBLE_EQ(gap, 3);
  EXPECT_LE((jacobian - Vector3(0, 0.6, 0.8)).norm(), 1e-16);
  EXPECT_DOUBLE_EQ(ball.violation(0, inside.data()), 1.5);
}

TEST(SphereObstacle, IsFiniteAtItsVeryCentre) {
  SphereObstacle ball("ball", "cloth", {0}, 0, 1.0, 2.0);
  const Vector3 centre = Vector3::Zero();
  Vector3 jacobian;
  Matrix3 hessian;
  double gap, multiplier = -1;
  ball.evaluate(0, centre.data(), &gap, jacobian.data());
  ball.hessian(0, centre.data(), &multiplier, Curvature::exact, hessian.data());
  EXPECT_EQ(gap, -2);
  EXPECT_DOUBLE_EQ(jacobian.norm(), 1);
  EXPECT_TRUE(hessian.allFinite());
}

}  // namespace
}  // namespace taut
