#include "geometry/grid.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numeric>

#include "geometry/measures.h"
#include "geometry/topology.h"

namespace taut {
namespace {

class EveryPattern : public testing::TestWithParam<Diagonals> {};

TEST_P(EveryPattern, IsAValidSurfaceThatCoversTheRectangleOnce) {
  const TriangleMesh grid = make_grid(2.0, 3.0, 3, 5, GetParam());
  EXPECT_NO_THROW(validate(grid, "grid"));
  const std::vector<double> areas = triangle_areas(grid);
  EXPECT_NEAR(std::accumulate(areas.begin(), areas.end(), 0.0), 6.0, 1e-14);
  EXPECT_EQ(boundary_vertices(grid).size(), 2u * (3 + 5));
  const std::size_t euler = grid.vertices.size() - edges(grid).size() + grid.triangles.size();
  EXPECT_EQ(euler, 1u);
}

TEST_P(EveryPattern, IsCounterClockwiseSeenFromAbove) {
  const TriangleMesh grid = make_grid(2.0, 3.0, 3, 5, GetParam());
  for (const Triangle& t : grid.triangles) {
    const Vector3 normal = (grid.vertices[t[1]] - grid.vertices[t[0]]).cross(grid.vertices[t[2]] - grid.vertices[t[0]]);
    EXPECT_GT(normal.z(), 0);
  }
}

TEST_P(EveryPattern, NumbersTheCornersOfItsCellsRowByRow) {
  const TriangleMesh grid = make_grid(2.0, 3.0, 3, 5, GetParam());
  EXPECT_EQ(grid.cells_x, 3);
  EXPECT_EQ(grid.cells_y, 5);
  for (int j = 0; j <= 5; ++j) {
    for (int i = 0; i <= 3; ++i) EXPECT_EQ(grid.vertices[j * 4 + i], Vector3(2.0 * i / 3, 3.0 * j / 5, 0));
  }
}

TEST_P(EveryPattern, HasItsRestPositionsAsUv) {
  const TriangleMesh grid = make_grid(2.0, 3.0, 3, 5, GetParam());
  ASSERT_EQ(grid.corner_uv.size(), grid.triangles.size());
  for (std::size_t t = 0; t < grid.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(grid.corner_uv[t][k], grid.vertices[grid.triangles[t][k]].head<2>());
  }
}

INSTANTIATE_TEST_SUITE_P(Grid, EveryPattern,
                         testing::Values(Diagonals::alternating, Diagonals::left, Diagonals::right,
                                         Diagonals::union_jack));

std::vector<int> triangles_per_vertex(const TriangleMesh& mesh) {
  std::vector<int> count(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const int v : t) ++count[v];
  }
  return count;
}

bool has_edge(const TriangleMesh& mesh, int a, int b) {
  for (const Edge& edge : edges(mesh)) {
    if ((edge.v0 == a && edge.v1 == b) || (edge.v0 == b && edge.v1 == a)) return true;
  }
  return false;
}

TEST(Grid, LeftAndRightDiagonalsLeanTheWayTheirNamesSay) {
  EXPECT_TRUE(has_edge(make_grid(1, 1, 1, 1, Diagonals::right), 0, 3));
  EXPECT_TRUE(has_edge(make_grid(1, 1, 1, 1, Diagonals::left), 1, 2));
}

TEST(Grid, AlternatingDiagonalsMakeStarsOfEightAtEvenVerticesAndCrossesOfFourBetween) {
  const TriangleMesh grid = make_grid(1, 1, 6, 6, Diagonals::alternating);
  const std::vector<int> count = triangles_per_vertex(grid);
  for (int j = 1; j < 6; ++j) {
    for (int i = 1; i < 6; ++i) EXPECT_EQ(count[j * 7 + i], (i + j) % 2 == 0 ? 8 : 4);
  }
  EXPECT_EQ(count[0], 2);
}

TEST(Grid, UnionJackMakesStarsOfEightAtEveryInnerCellCornerAndCrossesOfFourInTheCells) {
  const TriangleMesh grid = make_grid(1, 2, 4, 3, Diagonals::union_jack);
  ASSERT_EQ(grid.vertices.size(), 5u * 4 + 4 * 3);
  const std::vector<int> count = triangles_per_vertex(grid);
  for (int j = 1; j < 3; ++j) {
    for (int i = 1; i < 4; ++i) EXPECT_EQ(count[j * 5 + i], 8);
  }
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(count[20 + j * 4 + i], 4);
      EXPECT_EQ(grid.vertices[20 + j * 4 + i], Vector3((i + 0.5) / 4, 2 * (j + 0.5) / 3, 0));
    }
  }
}

TEST(Grid, RefusesSizesAndCellCountsThatMakeNoSheet) {
  EXPECT_THROW(make_grid(0, 1, 1, 1, Diagonals::left), std::invalid_argument);
  EXPECT_THROW(make_grid(1, -1, 1, 1, Diagonals::left), std::invalid_argument);
  EXPECT_THROW(make_grid(1, std::numeric_limits<double>::infinity(), 1, 1, Diagonals::left), std::invalid_argument);
  EXPECT_THROW(make_grid(std::nan(""), 1, 1, 1, Diagonals::left), std::invalid_argument);
  EXPECT_THROW(make_grid(1, 1, 0, 1, Diagonals::left), std::invalid_argument);
  EXPECT_THROW(make_grid(1, 1, 1, -2, Diagonals::left), std::invalid_argument);
  EXPECT_THROW(make_grid(1, 1, 100000, 100000, Diagonals::left), std::invalid_argument);
}

}  // namespace
}  // namespace taut
