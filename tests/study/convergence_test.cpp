#include "study/convergence.h"

#include <gtest/gtest.h>

#include <cmath>

namespace taut {
namespace {

/// Differences of levels whose error is c h^order, h doubling from level to level.
Convergence of_order(double order, double c, int simplest, int finest_known) {
  Convergence convergence;
  for (int level = simplest; level >= finest_known; --level)
    convergence.add(level, c * (std::pow(2, order * level) - std::pow(2, order * (level - 1))));
  return convergence;
}

double true_error(double order, double c, int level) { return c * (std::pow(2, order * level) - 1); }

TEST(Convergence, TwoDifferencesGiveTheErrorOfAPower) {
  for (const double order : {0.5, 1.0, 2.0}) {
    const Convergence convergence = of_order(order, 0.01, 4, 3);
    for (int level = 0; level <= 4; ++level)
      EXPECT_NEAR(convergence.error(level), true_error(order, 0.01, level), 1e-12) << order << " " << level;
  }
}

TEST(Convergence, OneDifferenceIsTakenForFirstOrder) {
  const Convergence convergence = of_order(1, 0.01, 3, 3);
  EXPECT_NEAR(convergence.error(3), true_error(1, 0.01, 3), 1e-12);
  EXPECT_NEAR(convergence.error(1), true_error(1, 0.01, 1), 1e-12);
  EXPECT_LT(convergence.least_error(1), convergence.error(1)) << "it may be of second order";
}

TEST(Convergence, DifferencesThatGrowAreNoConvergence) {
  Convergence convergence;
  convergence.add(3, 0.1);
  convergence.add(2, 0.2);
  EXPECT_EQ(convergence.ratio(), Convergence::largest_ratio);
  EXPECT_GT(convergence.error(1), 0.15);
}

TEST(Convergence, NothingIsKnownWithoutDifferencesOrOfWhatWasNotSolved) {
  Convergence convergence;
  EXPECT_TRUE(std::isinf(convergence.error(1)));
  EXPECT_EQ(convergence.error(0), 0);
  convergence.add(2, INFINITY);
  EXPECT_TRUE(std::isinf(convergence.error(1)));
}

}  // namespace
}  // namespace taut
