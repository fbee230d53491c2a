#include "study/chart_records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace taut {
namespace {

using testing::ElementsAre;

ChartPoint point(const std::string& solver, double seconds, double error, const std::string& status = "solved") {
  ChartPoint p;
  p.solver = solver;
  p.outcome = "finished";
  p.status = status;
  p.solver_seconds = seconds;
  p.counts.linear_solves = std::lround(10 * seconds);
  p.steps_asked = 1;
  p.error = error;
  return p;
}

/// Two problems at one value, two solvers.
ChartData two_problems() {
  ChartData chart;
  chart.solvers = {"a", "b"};
  chart.max_seconds = 7;
  chart.accuracy = 0.01;
  chart.problems.resize(2);
  chart.problems[0].points = {point("a", 1, 1e-3), point("b", 3, 1e-4)};
  chart.problems[1].points = {point("a", 2, 0.5), point("b", 1, 1e-4)};
  return chart;
}

TEST(ChartFront, HasSolvedPointsOnly) {
  std::vector<ChartPoint> points{point("a", 1, 1e-9, "stalled"), point("a", 2, 1e-2), point("b", 3, 1e-3),
                                 point("b", 4, 1e-1)};
  points.push_back(point("b", 0.1, 0));
  points.back().error.reset();
  mark_front(points);
  std::vector<bool> marks;
  for (const ChartPoint& p : points) marks.push_back(p.on_front);
  EXPECT_THAT(marks, ElementsAre(false, true, true, false, false));
}

TEST(ChartFront, CheapestBelowAnErrorIsASolvedPoint) {
  const std::vector<ChartPoint> points{point("a", 1, 1e-9, "stalled"), point("a", 2, 1e-2), point("b", 3, 1e-3)};
  EXPECT_EQ(cheapest_below(points, 0.1)->solver, "a");
  EXPECT_EQ(cheapest_below(points, 1e-3)->solver, "b");
  EXPECT_EQ(cheapest_below(points, 1e-4), nullptr);
}

TEST(ChartScores, ASolvedRunWithALargeErrorIsNotCorrect) {
  const std::vector<SolverScore> scores = scores_of(two_problems());
  EXPECT_EQ(scores[0].solved, 2);
  EXPECT_EQ(scores[0].correct, 1);
  // By hand: the other counts max_seconds = 7, and sqrt((1 + 1)(7 + 1)) - 1 = 3.
  EXPECT_NEAR(scores[0].mean_seconds, 3, 1e-12);
  EXPECT_EQ(scores[1].correct, 2);
  EXPECT_NEAR(scores[1].mean_seconds, std::sqrt(8) - 1, 1e-12);
}

TEST(ChartScores, FalseSuccessesAreCountedByRun) {
  ChartData chart = two_problems();
  chart.problems[0].points[0].false_successes = 5;
  EXPECT_EQ(scores_of(chart)[0].false_successes, 1);
}

TEST(ChartProfiles, WhatIsNotCorrectIsNotSolved) {
  const ChartProfiles profiles = profiles_of(two_problems());
  EXPECT_THAT(profiles.performance[0].share, ElementsAre(0.5));
  EXPECT_THAT(profiles.performance[1].x, ElementsAre(1, 3));
  EXPECT_THAT(profiles.performance[1].share, ElementsAre(0.5, 1));
  EXPECT_THAT(profiles.data[1].x, ElementsAre(10, 30));
}

TEST(ChartOrder, IgnoresErrorsBelowTheReferencesOwn) {
  std::vector<ChartPoint> points{point("a", 1, 0.04), point("a", 2, 0.01), point("a", 3, 1e-4)};
  for (std::size_t k = 0; k < 3; ++k) points[k].number = std::pow(0.5, static_cast<double>(k));
  EXPECT_NEAR(order_of(points, "a", 1e-3).value(), 2, 1e-12);
  EXPECT_FALSE(order_of(points, "a", 0.02));
  EXPECT_FALSE(order_of(points, "b", 0));
}

}  // namespace
}  // namespace taut
