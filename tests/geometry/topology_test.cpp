#include "geometry/topology.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "geometry/grid.h"

namespace taut {
namespace {

TriangleMesh two_triangles() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

std::string complaint(const TriangleMesh& mesh) {
  try {
    validate(mesh, "cloth.obj");
  } catch (const MeshError& error) {
    return error.what();
  }
  return "";
}

TEST(Edges, ComeInTheOrderAndDirectionOfTheirFirstAppearance) {
  const std::vector<Edge> all = edges(two_triangles());
  std::vector<std::array<int, 2>> ends;
  for (const Edge& edge : all) ends.push_back({edge.v0, edge.v1});
  EXPECT_EQ(ends, (std::vector<std::array<int, 2>>{{0, 1}, {1, 2}, {2, 0}, {2, 3}, {3, 0}}));
}

TEST(Edges, KnowTheirTrianglesAndOppositeVertices) {
  const std::vector<Edge> all = edges(two_triangles());
  const Edge& inner = all[2];
  EXPECT_EQ(inner.left, 0);
  EXPECT_EQ(inner.right, 1);
  EXPECT_EQ(inner.opposite_left, 1);
  EXPECT_EQ(inner.opposite_right, 3);
  const Edge& border = all[4];
  EXPECT_EQ(border.left, 1);
  EXPECT_EQ(border.right, -1);
  EXPECT_EQ(border.opposite_left, 2);
  EXPECT_EQ(border.opposite_right, -1);
}

TEST(Boundary, OfAGridIsItsRim) {
  EXPECT_EQ(boundary_vertices(make_grid(1, 1, 2, 2, Diagonals::alternating)),
            (std::vector<int>{0, 1, 2, 3, 5, 6, 7, 8}));
}

TEST(Boundary, IsThereForASheetAndNotForATetrahedron) {
  EXPECT_TRUE(boundary_vertices(tetrahedron()).empty());
  EXPECT_TRUE(is_closed(tetrahedron()));
  EXPECT_FALSE(is_closed(two_triangles()));
  EXPECT_FALSE(is_closed(TriangleMesh{}));
}

TEST(Validate, AcceptsSheetsAndClosedSurfaces) {
  EXPECT_EQ(complaint(two_triangles()), "");
  EXPECT_EQ(complaint(tetrahedron()), "");
}

TEST(Validate, AcceptsTwoFansThatTouchInOneVertex) {
  TriangleMesh mesh = two_triangles();
  mesh.vertices.insert(mesh.vertices.end(), {{2, 1, 0}, {2, 2, 0}});
  mesh.triangles.push_back({2, 4, 5});
  EXPECT_EQ(complaint(mesh), "");
}

TEST(Validate, NamesAnIndexOutOfRange) {
  TriangleMesh mesh = two_triangles();
  mesh.triangles[1][2] = 4;
  EXPECT_EQ(complaint(mesh), "cloth.obj: face 1 (vertices 0, 2, 4): vertex 4 is out of range, the mesh has 4 vertices");
  mesh.triangles[1][2] = -1;
  EXPECT_EQ(complaint(mesh),
            "cloth.obj: face 1 (vertices 0, 2, -1): vertex -1 is out of range, the mesh has 4 vertices");
}

TEST(Validate, NamesARepeatedVertex) {
  TriangleMesh mesh = two_triangles();
  mesh.triangles[1] = {0, 2, 2};
  EXPECT_EQ(complaint(mesh), "cloth.obj: face 1 (vertices 0, 2, 2): repeated vertex");
}

TEST(Validate, NamesAZeroAreaWhateverTheUnit) {
  for (const double scale : {1e-6, 1.0, 1e6}) {
    TriangleMesh mesh = two_triangles();
    mesh.vertices[3] = {0.25, 0.25, 0};
    for (Vector3& vertex : mesh.vertices) vertex *= scale;
    EXPECT_EQ(complaint(mesh), "cloth.obj: face 1 (vertices 0, 2, 3): zero area");
  }
}

TEST(Validate, AcceptsASmallTriangleWithAnArea) {
  TriangleMesh mesh = two_triangles();
  for (Vector3& vertex : mesh.vertices) vertex *= 1e-9;
  EXPECT_EQ(complaint(mesh), "");
}

TEST(Validate, DrawsTheLineForSliversAt1e12thOfTheLongestEdgeSquared) {
  TriangleMesh mesh = two_triangles();
  mesh.triangles.resize(1);
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 2.2e-12, 0}};
  EXPECT_EQ(complaint(mesh), "");
  mesh.vertices[2].y() = 1.8e-12;
  EXPECT_EQ(complaint(mesh), "cloth.obj: face 0 (vertices 0, 1, 2): zero area");
}

TEST(Validate, NamesAnAreaThatOverflows) {
  TriangleMesh mesh = two_triangles();
  for (Vector3& vertex : mesh.vertices) vertex *= 1e200;
  EXPECT_EQ(complaint(mesh), "cloth.obj: face 0 (vertices 0, 1, 2): area is not finite");
}

TEST(Validate, NamesAVertexThatIsNotFinite) {
  TriangleMesh mesh = two_triangles();
  mesh.vertices[2].y() = std::nan("");
  EXPECT_EQ(complaint(mesh), "cloth.obj: vertex 2: coordinates are not finite");
  mesh.vertices[2].y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(complaint(mesh), "cloth.obj: vertex 2: coordinates are not finite");
}

TEST(Validate, NamesADuplicateWhicheverWayItTurns) {
  TriangleMesh mesh = two_triangles();
  mesh.triangles.push_back({1, 2, 0});
  EXPECT_EQ(complaint(mesh), "cloth.obj: face 2 (vertices 1, 2, 0): duplicate of face 0");
  mesh.triangles[2] = {1, 0, 2};
  EXPECT_EQ(complaint(mesh), "cloth.obj: face 2 (vertices 1, 0, 2): duplicate of face 0");
}

TEST(Validate, NamesTheThirdFaceOnAnEdge) {
  TriangleMesh mesh = two_triangles();
  mesh.vertices.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 2, 4});
  EXPECT_EQ(complaint(mesh), "cloth.obj: face 2 (vertices 0, 2, 4): third face on edge 2-0, after faces 0 and 1");
}

TEST(Validate, NamesANeighbourThatTurnsTheOtherWay) {
  TriangleMesh mesh = two_triangles();
  mesh.triangles[1] = {0, 3, 2};
  EXPECT_EQ(
      complaint(mesh),
      "cloth.obj: face 1 (vertices 0, 3, 2): runs through edge 2-0 the same way as face 0 (inconsistent orientation)");
}

TEST(Validate, NamesAVertexThatNoFaceUses) {
  TriangleMesh mesh = two_triangles();
  mesh.vertices.insert(mesh.vertices.begin() + 4, 2, Vector3(5, 5, 5));
  EXPECT_EQ(complaint(mesh), "cloth.obj: vertex 4: used by no face (2 such in all)");
}

TEST(Validate, RefusesAMeshWithoutFaces) { EXPECT_EQ(complaint(TriangleMesh{}), "cloth.obj: no faces"); }

}  // namespace
}  // namespace taut
