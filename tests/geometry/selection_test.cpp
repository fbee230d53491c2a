#include "geometry/selection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/grid.h"

namespace taut {
namespace {

using Indices = std::vector<int>;

TriangleMesh sheet() { return make_grid(2, 1, 2, 1, Diagonals::right); }  // 3 4 5 above 0 1 2

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

template <class Function>
std::string complaint(Function&& select) {
  try {
    select();
  } catch (const SelectionError& error) {
    return error.what();
  }
  return "";
}

TEST(Selection, ByIndexIsAscendingWithoutRepetition) {
  EXPECT_EQ(select_indices(sheet(), Indices{4, 0, 4, 2}, "cloth"), (Indices{0, 2, 4}));
}

TEST(Selection, ByIndexNamesTheOneOutOfRange) {
  EXPECT_EQ(complaint([] {
              select_indices(sheet(), Indices{0, 6}, "cloth");
            }),
            "vertex 6 is not one of cloth (6 vertices)");
  EXPECT_EQ(complaint([] { select_indices(sheet(), Indices{-1}, "cloth"); }),
            "vertex -1 is not one of cloth (6 vertices)");
  EXPECT_EQ(complaint([] { select_indices(sheet(), Indices{}, "cloth"); }),
            "an empty list of vertices selects no vertex of cloth (6 vertices)");
}

TEST(Selection, ByCornerNameFindsTheFourCorners) {
  EXPECT_EQ(select_corner(sheet(), "x0y0", "cloth"), Indices{0});
  EXPECT_EQ(select_corner(sheet(), "x1y0", "cloth"), Indices{2});
  EXPECT_EQ(select_corner(sheet(), "x0y1", "cloth"), Indices{3});
  EXPECT_EQ(select_corner(sheet(), "x1y1", "cloth"), Indices{5});
}

TEST(Selection, ByEdgeNameFindsTheFourEdgesWithTheirCorners) {
  EXPECT_EQ(select_edge(sheet(), "x0", "cloth"), (Indices{0, 3}));
  EXPECT_EQ(select_edge(sheet(), "x1", "cloth"), (Indices{2, 5}));
  EXPECT_EQ(select_edge(sheet(), "y0", "cloth"), (Indices{0, 1, 2}));
  EXPECT_EQ(select_edge(sheet(), "y1", "cloth"), (Indices{3, 4, 5}));
}

TEST(Selection, ByEdgeNameSurvivesATransformationOfThePositions) {
  for (const Diagonals diagonals : {Diagonals::alternating, Diagonals::union_jack}) {
    TriangleMesh mesh = make_grid(1, 1, 3, 2, diagonals);
    const Indices before = select_edge(mesh, "y1", "cloth");
    for (const int v : before) EXPECT_EQ(mesh.vertices[v].y(), 1);
    for (Vector3& v : mesh.vertices) v = Vector3(v.z() + 5, -v.x(), v.y() * 2);
    EXPECT_EQ(select_edge(mesh, "y1", "cloth"), before);
  }
}

TEST(Selection, ByCornerOrEdgeIsForGridsOnly) {
  EXPECT_EQ(complaint([] { select_corner(tetrahedron(), "x0y0", "rock"); }),
            "corner x0y0 is for grids, and rock (4 vertices) is not one");
  EXPECT_EQ(complaint([] { select_edge(tetrahedron(), "x0", "rock"); }),
            "edge x0 is for grids, and rock (4 vertices) is not one");
}

TEST(Selection, RefusesNamesThatNoGridHas) {
  EXPECT_THROW(select_corner(sheet(), "x2y0", "cloth"), std::invalid_argument);
  EXPECT_THROW(select_edge(sheet(), "z0", "cloth"), std::invalid_argument);
}

TEST(Selection, ByBoxIncludesItsBorderWithASlackOfABillionthOfTheMesh) {
  const TriangleMesh mesh = sheet();
  EXPECT_EQ(select_box(mesh, {0, 0, 0}, {1, 1, 0}, "cloth"), (Indices{0, 1, 3, 4}));
  EXPECT_EQ(select_box(mesh, {0, 0, 0}, {1 - 2e-9, 1, 0}, "cloth"), (Indices{0, 1, 3, 4}));
  EXPECT_EQ(select_box(mesh, {0, 0, 0}, {1 - 3e-9, 1, 0}, "cloth"), (Indices{0, 3}));
}

TEST(Selection, ByBoxSaysWhichBoxIsEmpty) {
  EXPECT_EQ(complaint([] {
              select_box(sheet(), {0, 0, 1}, {0.5, 1, 2}, "cloth");
            }),
            "the box from (0, 0, 1) to (0.5, 1, 2) selects no vertex of cloth (6 vertices)");
  EXPECT_THROW(select_box(sheet(), {1, 0, 0}, {0, 1, 1}, "cloth"), std::invalid_argument);
}

TEST(Selection, BySphereIncludesItsBorder) {
  EXPECT_EQ(select_sphere(sheet(), {0, 0, 0}, 1, "cloth"), (Indices{0, 1, 3}));
  EXPECT_EQ(select_sphere(sheet(), {1, 0, 0}, 0, "cloth"), Indices{1});
  EXPECT_EQ(complaint([] {
              select_sphere(sheet(), {0, 0, 3}, 1, "cloth");
            }),
            "the sphere around (0, 0, 3) of radius 1 selects no vertex of cloth (6 vertices)");
  EXPECT_THROW(select_sphere(sheet(), {0, 0, 0}, -1, "cloth"), std::invalid_argument);
  EXPECT_THROW(select_sphere(sheet(), {0, std::nan(""), 0}, 1, "cloth"), std::invalid_argument);
}

TEST(Selection, ByNearestPointTakesTheLowestIndexOfATie) {
  EXPECT_EQ(select_nearest(sheet(), {1.9, 2, 5}, "cloth"), Indices{5});
  EXPECT_EQ(select_nearest(sheet(), {0.5, 0.5, 0}, "cloth"), Indices{0});
  EXPECT_EQ(complaint([] {
              select_nearest(TriangleMesh{}, {1, 2, 3}, "cloth");
            }),
            "the vertex nearest to (1, 2, 3) selects no vertex of cloth (0 vertices)");
  EXPECT_THROW(select_nearest(sheet(), {std::nan(""), 0, 0}, "cloth"), std::invalid_argument);
}

TEST(Selection, ByBoundaryFindsTheRimAndRefusesAClosedSurface) {
  EXPECT_EQ(select_boundary(make_grid(1, 1, 2, 2, Diagonals::union_jack), "cloth"), (Indices{0, 1, 2, 3, 5, 6, 7, 8}));
  EXPECT_EQ(complaint([] { select_boundary(tetrahedron(), "rock"); }),
            "the boundary selects no vertex of rock (4 vertices)");
}

TEST(Selection, ByGroupNamesTheGroupsThereAre) {
  TriangleMesh mesh = sheet();
  EXPECT_EQ(complaint([&] { select_group(mesh, "hem", "cloth"); }),
            "there is no group \"hem\" in cloth (6 vertices); it has no groups");
  mesh.groups = {{"hem", {0, 1}}, {"none", {}}};
  EXPECT_EQ(select_group(mesh, "hem", "cloth"), (Indices{0, 1}));
  EXPECT_EQ(complaint([&] { select_group(mesh, "top", "cloth"); }),
            "there is no group \"top\" in cloth (6 vertices); it has \"hem\", \"none\"");
  EXPECT_EQ(complaint([&] { select_group(mesh, "none", "cloth"); }),
            "group \"none\" selects no vertex of cloth (6 vertices)");
}

TEST(Selection, OfAllIsEveryVertex) {
  EXPECT_EQ(select_all(sheet(), "cloth"), (Indices{0, 1, 2, 3, 4, 5}));
  EXPECT_THROW(select_all(TriangleMesh{}, "cloth"), SelectionError);
}

}  // namespace
}  // namespace taut
