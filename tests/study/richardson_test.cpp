#include "study/richardson.h"

#include <gtest/gtest.h>

#include <cmath>

namespace taut {
namespace {

double distance(const Vector& a, const Vector& b) { return (a - b).norm(); }

/// limit + c h^p, in two components.
Vector series(double h, double p) { return Vector2(2 + 3 * std::pow(h, p), -1 + 0.5 * std::pow(h, p)); }

TEST(Richardson, FindsOrderLimitAndErrorOfAKnownSeries) {
  for (const double order : {1.0, 2.0, 4.0}) {
    const auto found = richardson(series(0.4, order), series(0.2, order), series(0.1, order), 2, distance);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->order, order, 1e-9);
    EXPECT_NEAR(found->limit[0], 2, 1e-12);
    EXPECT_NEAR(found->limit[1], -1, 1e-12);
    EXPECT_NEAR(found->error, distance(series(0.1, order), Vector2(2, -1)), 1e-12);
  }
}

TEST(Richardson, TakesAnyRatio) {
  const auto found = richardson(series(0.9, 2), series(0.3, 2), series(0.1, 2), 3, distance);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->order, 2, 1e-9);
}

TEST(Richardson, FindsNothingWhereDifferencesFollowNoOrder) {
  const Vector one = Vector::Constant(1, 1.0), two = Vector::Constant(1, 2.0), three = Vector::Constant(1, 3.0);
  EXPECT_FALSE(richardson(one, two, three, 2, distance));  // order 0
  EXPECT_FALSE(richardson(one, one, one, 2, distance));
  EXPECT_FALSE(richardson(one, Vector::Constant(1, NAN), three, 2, distance));
  EXPECT_THROW(richardson(one, two, three, 1, distance), std::invalid_argument);
}

TEST(ObservedOrder, IsTheSlopeOfTheLogarithms) {
  // By hand: errors 3 h^2.
  EXPECT_NEAR(observed_order({0.1, 0.2, 0.4}, {0.03, 0.12, 0.48}).value(), 2, 1e-12);
  EXPECT_FALSE(observed_order({0.1}, {1.0}));
  EXPECT_FALSE(observed_order({0.1, 0.1}, {1.0, 2.0}));
  EXPECT_FALSE(observed_order({0.1, 0.2}, {1.0, 0.0}));
}

}  // namespace
}  // namespace taut
