#include "geometry/measures.h"

#include <gtest/gtest.h>

#include "geometry/grid.h"

namespace taut {
namespace {

TEST(Measures, AreaOfARightTriangleIsHalfTheProductOfItsLegs) {
  EXPECT_DOUBLE_EQ(triangle_area({1, 1, 1}, {1, 4, 1}, {1, 1, 5}), 6.0);
  EXPECT_EQ(triangle_areas(make_grid(3, 4, 1, 1, Diagonals::right)), (std::vector<double>{6, 6}));
}

TEST(Measures, BoxDiagonalOfABrickIsThreeDimensionalAndOfNothingZero) {
  TriangleMesh mesh;
  EXPECT_EQ(bounding_box_diagonal(mesh), 0);
  mesh.vertices = {{1, 0, 0}, {0, 2, 0}, {0, 0, 2}, {0.5, 0.5, 0.5}};
  EXPECT_DOUBLE_EQ(bounding_box_diagonal(mesh), 3.0);
}

TEST(Measures, MeanEdgeLengthCountsAnInnerEdgeOnce) {
  EXPECT_DOUBLE_EQ(mean_edge_length(make_grid(3, 4, 1, 1, Diagonals::right)), (3 + 4 + 3 + 4 + 5) / 5.0);
  EXPECT_THROW(mean_edge_length(TriangleMesh{}), std::invalid_argument);
}

}  // namespace
}  // namespace taut
