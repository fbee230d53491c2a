#include "geometry/layered_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/topology.h"
#include "support/meshes.h"

namespace taut {
namespace {

double volume(const LayeredMesh& layered) {
  double sum = 0;
  for (const Prism& prism : layered.prisms) {
    std::array<Vector3, 6> points;
    for (int j = 0; j < 6; ++j) points[j] = layered.nodes[prism[j]];
    sum += PrismJacobian(PrismShape(points)).volume();
  }
  return sum;
}

TEST(LayeredMesh, OfAFlatSheetFillsTheBox) {
  const TriangleMesh mesh = make_grid(2, 3, 4, 5, Diagonals::union_jack);
  const LayeredMesh layered = make_layered(mesh, std::vector{0.1}, {0.2, 0.3, 0.5}, "plate");
  EXPECT_EQ(layered.nodes.size(), 4 * mesh.vertices.size());
  EXPECT_EQ(layered.prisms.size(), 3 * mesh.triangles.size());
  EXPECT_NEAR(volume(layered), 0.6, 1e-14);
  EXPECT_NEAR(layered.nodes[layered.node(7, 0)].z(), -0.05, 1e-16);
  EXPECT_NEAR(layered.nodes[layered.node(7, 1)].z(), -0.03, 1e-16);
  EXPECT_NEAR(layered.nodes[layered.node(7, 3)].z(), 0.05, 1e-16);
}

TEST(LayeredMesh, SharesTheNodesOfAnInterface) {
  const TriangleMesh mesh = make_grid(1, 1, 1, 1, Diagonals::right);
  const LayeredMesh layered = make_layered(mesh, std::vector{0.1}, {0.5, 0.5}, "plate");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Prism &low = layered.prisms[t], &high = layered.prisms[mesh.triangles.size() + t];
    for (int j = 0; j < 3; ++j) EXPECT_EQ(low[2 * j + 1], high[2 * j]);
  }
}

TEST(LayeredMesh, OfACylinderConvergesToTheVolumeBetweenTheRadii) {
  double last = 1;
  for (int cells : {8, 16, 32}) {
    TriangleMesh mesh = make_grid(1.2, 1, cells, 1, Diagonals::alternating);
    for (Vector3& v : mesh.vertices) v = rolled(v, 1.0);
    const double error = std::abs(volume(make_layered(mesh, std::vector{0.3}, {1.0}, "shell")) - 1.2 * 0.3) / 0.36;
    EXPECT_LT(error, 0.3 * last);
    last = error;
  }
}

TEST(LayeredMesh, TakesAThicknessPerVertex) {
  const TriangleMesh mesh = make_grid(1, 1, 1, 1, Diagonals::right);
  // Linear in x: the mean of 0.1 and 0.3.
  EXPECT_NEAR(volume(make_layered(mesh, {0.1, 0.3, 0.1, 0.3}, {1.0}, "wedge")), 0.2, 1e-15);
}

TEST(LayeredMesh, NamesTheVertexOfAnInvertedPrism) {
  // A gutter of radius 0.1 cannot carry half a thickness of 0.2 inwards.
  TriangleMesh mesh = make_grid(0.4, 1, 8, 1, Diagonals::alternating);
  for (Vector3& v : mesh.vertices) v = rolled(v, 10.0);
  EXPECT_NO_THROW(make_layered(mesh, std::vector{0.1}, {1.0}, "gutter"));
  try {
    make_layered(mesh, std::vector{0.4}, {1.0}, "gutter");
    FAIL();
  } catch (const MeshError& error) {
    EXPECT_THAT(error.what(), testing::MatchesRegex("gutter: face [0-9]+, layer 0 \\(vertices [0-9]+, [0-9]+, "
                                                    "[0-9]+\\): inverted at vertex [0-9]+"));
  }
}

TEST(LayeredMesh, NamesTheFaceWhereTwoSurfacesCross) {
  const TriangleMesh mesh = make_grid(1, 1, 2, 2, Diagonals::right);
  std::vector<Vector3> bottom = mesh.vertices, top = mesh.vertices;
  for (Vector3& v : top) v.z() += 0.1;
  top[8].z() = -0.1;
  try {
    make_layered(mesh, bottom, top, {1.0}, "plate");
    FAIL();
  } catch (const MeshError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("inverted at vertex 8"));
  }
}

TEST(LayeredMesh, RefusesFractionsThatDoNotFillTheThickness) {
  const TriangleMesh mesh = make_grid(1, 1, 1, 1, Diagonals::right);
  EXPECT_THROW(make_layered(mesh, std::vector{0.1}, {0.5, 0.4}, "plate"), std::invalid_argument);
  EXPECT_THROW(make_layered(mesh, std::vector{0.1}, {1.5, -0.5}, "plate"), std::invalid_argument);
  EXPECT_THROW(make_layered(mesh, std::vector{0.1}, {}, "plate"), std::invalid_argument);
  EXPECT_THROW(make_layered(mesh, std::vector{0.1, 0.2}, {1.0}, "plate"), std::invalid_argument);
  EXPECT_THROW(make_layered(mesh, std::vector{-0.1}, {1.0}, "plate"), std::invalid_argument);
}

TEST(VertexNormals, OfAnOctahedronPointAway) {
  const TriangleMesh mesh = octahedron();
  const std::vector<Vector3> normals = vertex_normals(mesh);
  for (std::size_t v = 0; v < normals.size(); ++v) EXPECT_LE((normals[v] - mesh.vertices[v]).norm(), 1e-15);
}

}  // namespace
}  // namespace taut
