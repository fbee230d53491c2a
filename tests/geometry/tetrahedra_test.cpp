#include "geometry/tetrahedra.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "geometry/topology.h"

namespace taut {
namespace {

std::filesystem::path written(const std::string& name, const std::string& text) {
  const auto folder = std::filesystem::temp_directory_path() / "taut_tetrahedra_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / name) << text;
  return folder / name;
}

double volume_of(const TetrahedronMesh& mesh) {
  double sum = 0;
  for (const Tetrahedron& c : mesh.cells) {
    const Vector3& o = mesh.vertices[c[0]];
    const double volume = (mesh.vertices[c[1]] - o).cross(mesh.vertices[c[2]] - o).dot(mesh.vertices[c[3]] - o) / 6;
    EXPECT_GT(volume, 0);
    sum += volume;
  }
  return sum;
}

TEST(Tetrahedra, OfABoxFillItAndAreClosed) {
  const TetrahedronMesh box = make_box({2, 1, 0.5}, 4, 3, 2);
  EXPECT_NEAR(volume_of(box), 1, 1e-14);
  const auto faces = boundary_triangles(box.cells);
  EXPECT_EQ(faces.size(), 2 * 2 * (4 * 3 + 3 * 2 + 4 * 2));
  double volume = 0;  // by the divergence theorem: faces look outward
  for (const Triangle& t : faces) volume += box.vertices[t[0]].dot(box.vertices[t[1]].cross(box.vertices[t[2]])) / 6;
  EXPECT_NEAR(volume, 1, 1e-14);
}

constexpr const char* nodes = "$Nodes\n5\n10 0 0 0\n11 1 0 0\n12 0 1 0\n13 0 0 1\n99 7 7 7\n$EndNodes\n";

TEST(Tetrahedra, AreReadFromAGmshFileAndTurnedWhereInsideOut) {
  const auto file = written("good.msh", std::string("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n") + nodes +
                                            "$Elements\n2\n1 2 2 0 1 10 11 12\n2 4 2 0 1 10 12 11 13\n$EndElements\n");
  const TetrahedronMesh mesh = read_tetrahedra(file);
  EXPECT_EQ(mesh.vertices.size(), 4);
  ASSERT_EQ(mesh.cells.size(), 1);
  EXPECT_NEAR(volume_of(mesh), 1.0 / 6, 1e-15);
}

TEST(Tetrahedra, OtherFilesAreRefusedByName) {
  const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  for (const std::string& text :
       {std::string("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"), std::string("$MeshFormat\n2.2 1 8\n"), head + nodes,
        head + nodes + "$Elements\n1\n2 4 2 0 1 10 12 11 14\n", head + nodes + "$Elements\n1\n2 4 2 0 1 10 12 11\n",
        head + nodes + "$Elements\n1\n2 4 2 0 1 10 12 11 11\n", std::string("solid\n")}) {
    const auto file = written("bad.msh", text);
    try {
      read_tetrahedra(file);
      ADD_FAILURE() << text;
    } catch (const MeshError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(file.string() + ": ")) << error.what();
    }
  }
}

}  // namespace
}  // namespace taut
