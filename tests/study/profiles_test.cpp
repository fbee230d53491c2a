#include "study/profiles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace taut {
namespace {

using testing::DoubleEq;
using testing::ElementsAre;

constexpr double inf = INFINITY;

/// Four instances, two solvers; nobody solves the last.
Matrix four_instances() {
  Matrix costs(4, 2);
  costs << 1, 2, 6, 2, 4, inf, inf, inf;
  return costs;
}

TEST(PerformanceProfile, IsTheDistributionOfTheRatiosToTheBest) {
  // By hand: ratios of A are 1, 3, 1, inf; of B 2, 1, inf, inf.
  const std::vector<Profile> profiles = performance_profiles(four_instances());
  ASSERT_EQ(profiles.size(), 2u);
  EXPECT_THAT(profiles[0].x, ElementsAre(1, 3));
  EXPECT_THAT(profiles[0].share, ElementsAre(0.5, 0.75));
  EXPECT_THAT(profiles[1].x, ElementsAre(1, 2));
  EXPECT_THAT(profiles[1].share, ElementsAre(0.25, 0.5));
}

TEST(PerformanceProfile, StepsUpAtItsRatiosOnly) {
  const Profile a = performance_profiles(four_instances())[0];
  EXPECT_EQ(a(0.5), 0);
  EXPECT_EQ(a(1), 0.5);
  EXPECT_EQ(a(2.999), 0.5);
  EXPECT_EQ(a(3), 0.75);
  EXPECT_EQ(a(1e9), 0.75);
}

TEST(DataProfile, IsTheDistributionOfTheCosts) {
  const std::vector<Profile> profiles = data_profiles(four_instances());
  EXPECT_THAT(profiles[0].x, ElementsAre(1, 4, 6));
  EXPECT_THAT(profiles[0].share, ElementsAre(0.25, 0.5, 0.75));
  EXPECT_THAT(profiles[1].x, ElementsAre(2));
  EXPECT_THAT(profiles[1].share, ElementsAre(0.5));
}

TEST(Profiles, RefuseCostsThatAreNotPositive) {
  EXPECT_THROW(data_profiles(Matrix::Zero(1, 1)), std::invalid_argument);
  EXPECT_THROW(performance_profiles(Matrix::Constant(1, 1, NAN)), std::invalid_argument);
}

TEST(ShiftedGeometricMean, IsTheGeometricMeanOfTheShiftedValues) {
  // By hand: sqrt((1 + 1)(7 + 1)) - 1 = 3.
  EXPECT_THAT(shifted_geometric_mean({1, 7}, 1), DoubleEq(3));
  EXPECT_NEAR(shifted_geometric_mean({1, 10, 100}, 0), 10, 1e-12);
  EXPECT_NEAR(shifted_geometric_mean({0, 0}, 1), 0, 1e-15);
}

TEST(ShiftedGeometricMean, RefusesWhatHasNoLogarithm) {
  EXPECT_THROW(shifted_geometric_mean({}, 1), std::invalid_argument);
  EXPECT_THROW(shifted_geometric_mean({0}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace taut
