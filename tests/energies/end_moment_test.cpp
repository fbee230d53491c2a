#include "energies/end_moment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace taut {
namespace {

constexpr double pi = std::numbers::pi;

/// A director of length 0.2 about (1, 2, 3), turned from z by `angle` about the y axis.
Vector turned(double angle) {
  const Vector3 middle(1, 2, 3), half = 0.1 * Vector3(std::sin(angle), 0, std::cos(angle));
  Vector x(6);
  x.head<3>() = middle - half;
  x.tail<3>() = middle + half;
  return x;
}

EndMoment about_y() { return {"moment", {{0, 1, 3.0}}, Vector3(0, 2, 0), turned(0)}; }

TEST(EndMoment, DoesItsMomentTimesTheAngleOfWork) {
  const EndMoment moment = about_y();
  for (double angle : {-3.0, -0.5, 0.0, 0.7, 3.1}) {
    EXPECT_NEAR(moment.evaluate(0, turned(angle).data(), nullptr, nullptr, Curvature::exact), -3 * angle, 1e-13);
  }
}

TEST(EndMoment, IsACoupleWithThatMomentAndNoForce) {
  const EndMoment moment = about_y();
  const Vector x = turned(0.7);
  Vector gradient(6);
  moment.evaluate(0, x.data(), gradient.data(), nullptr, Curvature::exact);
  EXPECT_LE((gradient.head<3>() + gradient.tail<3>()).norm(), 1e-14);
  const Vector3 director = x.tail<3>() - x.head<3>();
  const Vector3 couple = director.cross(-gradient.tail<3>());
  EXPECT_LE((couple - Vector3(0, 3, 0)).norm(), 1e-13);
}

TEST(EndMoment, TurnsPastAFullOneWhereItsReferenceFollows) {
  EndMoment moment = about_y();
  for (int step = 1; step <= 30; ++step) {
    const Vector x = turned(0.1 * pi * step);
    EXPECT_NEAR(moment.evaluate(0, x.data(), nullptr, nullptr, Curvature::exact), -0.3 * pi, 1e-12);
    moment.set_reference(x);
    EXPECT_NEAR(moment.evaluate(0, x.data(), nullptr, nullptr, Curvature::exact), 0, 1e-12);
  }
}

TEST(EndMoment, ScalesWithItsFactor) {
  EndMoment moment = about_y();
  moment.set_factor(0.5);
  EXPECT_NEAR(moment.evaluate(0, turned(1).data(), nullptr, nullptr, Curvature::exact), -1.5, 1e-13);
}

TEST(EndMoment, RefusesAnAxisAlongADirectorAndOneWithoutLength) {
  EXPECT_THROW(EndMoment("moment", {{0, 1, 3.0}}, Vector3(0, 0, 1), turned(0)), std::invalid_argument);
  EXPECT_THROW(EndMoment("moment", {{0, 1, 3.0}}, Vector3::Zero(), turned(0)), std::invalid_argument);
}

}  // namespace
}  // namespace taut
