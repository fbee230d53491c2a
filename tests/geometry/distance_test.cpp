#include "geometry/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace taut {
namespace {

TEST(PointSegmentDistance, IsToTheInteriorOrTheNearerEnd) {
  const Vector3 a(0, 0, 0), b(2, 0, 0);
  const SegmentDistance inside = point_segment_distance({0.5, 3, 4}, a, b);
  EXPECT_DOUBLE_EQ(inside.distance, 5);
  EXPECT_DOUBLE_EQ(inside.parameter, 0.25);
  EXPECT_EQ(inside.nearest, Vector3(0.5, 0, 0));
  EXPECT_EQ(point_segment_distance({-3, 4, 0}, a, b).distance, 5);
  EXPECT_EQ(point_segment_distance({5, 0, 4}, a, b).nearest, b);
}

TEST(PointSegmentDistance, OfAPointSegmentIsToThatPoint) {
  const SegmentDistance d = point_segment_distance({1, 2, 2}, Vector3::Zero(), Vector3::Zero());
  EXPECT_DOUBLE_EQ(d.distance, 3);
  EXPECT_EQ(d.parameter, 0);
}

TEST(PointTriangleDistance, IsExactAboveTheFaceBesideAnEdgeAndBeyondACorner) {
  const Vector3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  const TriangleDistance above = point_triangle_distance({1, 2, -3}, a, b, c);
  EXPECT_DOUBLE_EQ(above.distance, 3);
  EXPECT_TRUE(above.weights.isApprox(Vector3(0.25, 0.25, 0.5), 1e-15));
  const TriangleDistance beside = point_triangle_distance({1, -3, 4}, a, b, c);
  EXPECT_DOUBLE_EQ(beside.distance, 5);
  EXPECT_TRUE(beside.nearest.isApprox(Vector3(1, 0, 0)));
  const TriangleDistance beyond = point_triangle_distance({-2, -1, 2}, a, b, c);
  EXPECT_DOUBLE_EQ(beyond.distance, 3);
  EXPECT_EQ(beyond.weights, Vector3(1, 0, 0));
}

TEST(PointTriangleDistance, BeyondAnObtuseCornerIsToTheFarEdgeNotTheCorner) {
  // Below the long edge a-b, yet on the outer side of a-c too.
  const TriangleDistance d = point_triangle_distance({0.1, -1, 0}, {0, 0, 0}, {10, 0, 0}, {-5, 1, 0});
  EXPECT_DOUBLE_EQ(d.distance, 1);
  EXPECT_NEAR(d.weights[1], 0.01, 1e-15);
}

TEST(PointTriangleDistance, OfATriangleWithoutAreaIsToItsLongestExtent) {
  const TriangleDistance d = point_triangle_distance({2, 2, 0}, {0, 0, 0}, {1, 0, 0}, {3, 0, 0});
  EXPECT_DOUBLE_EQ(d.distance, 2);
  EXPECT_TRUE(d.nearest.isApprox(Vector3(2, 0, 0)));
}

TEST(PointTriangleDistance, FulfilsTheOptimalityConditionOfTheProjectionForRandomTriangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto draw = [&] { return Vector3(uniform(random), uniform(random), uniform(random)); };
  for (int trial = 0; trial < 2000; ++trial) {
    const Vector3 p = 2 * draw(), a = draw(), b = draw(), c = draw();
    const TriangleDistance d = point_triangle_distance(p, a, b, c);
    EXPECT_NEAR(d.weights.sum(), 1, 1e-12);
    EXPECT_GE(d.weights.minCoeff(), 0);
    EXPECT_LT((d.weights[0] * a + d.weights[1] * b + d.weights[2] * c - d.nearest).norm(), 1e-12);
    EXPECT_NEAR((p - d.nearest).norm(), d.distance, 1e-12);
    // x is the projection of p on a convex set exactly where (p - x) . (y - x) <= 0 for its corners y.
    for (const Vector3& y : {a, b, c}) EXPECT_LE((p - d.nearest).dot(y - d.nearest), 1e-11);
  }
}

}  // namespace
}  // namespace taut
