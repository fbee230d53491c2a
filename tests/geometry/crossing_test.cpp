#include "geometry/crossing.h"

#include <gtest/gtest.h>

#include "support/meshes.h"

namespace taut {
namespace {

TEST(FindCrossing, FindsNothingInAClosedSurface) {
  const TriangleMesh mesh = octahedron();
  EXPECT_FALSE(find_crossing(mesh.vertices, mesh.triangles));
}

TEST(FindCrossing, LetsTheSidesOfASlitTouch) {
  // Two triangles that share an edge in space but no vertex.
  const std::vector<Vector3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  EXPECT_FALSE(find_crossing(points, {{0, 1, 2}, {3, 5, 4}}));
}

TEST(FindCrossing, NamesTheFirstPair) {
  const std::vector<Vector3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, -1}, {0.3, 0.2, 1}, {0.2, 0.3, 1}};
  const auto crossing = find_crossing(points, {{0, 1, 2}, {3, 4, 5}});
  ASSERT_TRUE(crossing);
  EXPECT_EQ(crossing->first, 0);
  EXPECT_EQ(crossing->second, 1);
}

}  // namespace
}  // namespace taut
