#include "geometry/mesh_property.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "geometry/topology.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

class MeshProperty : public FilesTest {
 protected:
  std::string header(const std::string& format, const std::string& more = "property float thickness\n") const {
    return "ply\nformat " + format + " 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty float z\n" +
           more + "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  }
  std::filesystem::path write(const std::string& text) const {
    std::ofstream(path("m.ply"), std::ios::binary) << text;
    return path("m.ply");
  }
  std::string error(const std::string& text) const {
    try {
      read_vertex_property(write(text), "thickness");
    } catch (const MeshError& e) {
      return e.what();
    }
    return "no error";
  }
};

template <class Number>
std::string bytes(Number number, bool big_endian) {
  std::string text(reinterpret_cast<const char*>(&number), sizeof number);
  if (big_endian) std::reverse(text.begin(), text.end());
  return text;
}

TEST_F(MeshProperty, IsReadFromText) {
  const auto file = write(header("ascii") + "0 0 0 0.5 255\n1 0 0 0.25 0\n0 1 0 2 7\n3 0 1 2\n");
  EXPECT_THAT(read_vertex_property(file, "thickness"), testing::ElementsAre(0.5, 0.25, 2));
  EXPECT_THAT(read_vertex_property(file, "red"), testing::ElementsAre(255, 0, 7));
}

TEST_F(MeshProperty, IsReadFromBothOrdersOfBytes) {
  for (const bool big : {false, true}) {
    std::string text = header(big ? "binary_big_endian" : "binary_little_endian");
    for (const float value : {0.5f, 0.25f, 2.0f}) {
      text += bytes(0.0f, big) + bytes(1.0, big) + bytes(0.0f, big) + bytes(value, big) + std::string(1, char(9));
    }
    EXPECT_THAT(read_vertex_property(write(text), "thickness"), testing::ElementsAre(0.5, 0.25, 2)) << big;
  }
}

TEST_F(MeshProperty, IsRefusedWhereItIsNotThere) {
  EXPECT_THAT(error(header("ascii", "") + "0 0 0 1\n"),
              testing::HasSubstr("m.ply: its vertices have no property \"thickness\""));
  EXPECT_THAT(error(header("ascii") + "0 0 0 0.5 255\n1 0"), testing::HasSubstr("m.ply: ends before vertex 1"));
  EXPECT_THROW(read_vertex_property(path("m.obj"), "thickness"), MeshError);
}

}  // namespace
}  // namespace taut
