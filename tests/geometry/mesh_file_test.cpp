#include "geometry/mesh_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <fstream>
#include <numeric>

#include "geometry/grid.h"
#include "geometry/measures.h"

namespace taut {
namespace {

/// A folder of its own for each test, so that tests may run side by side.
class MeshFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) / ("taut_mesh_file_" + std::to_string(getpid()) + "_" +
                                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }
  TriangleMesh read(const std::string& name, const std::string& content) const {
    return read_mesh(write(name, content));
  }

  /// What read_mesh says about the file, without its folder; "" where it reads it.
  std::string complaint_about(const std::filesystem::path& path) const {
    try {
      read_mesh(path);
    } catch (const MeshError& error) {
      const std::string text = error.what();
      return text.starts_with(folder_.string()) ? text.substr(folder_.string().size() + 1) : text;
    }
    return "";
  }
  std::string complaint(const std::string& name, const std::string& content) const {
    return complaint_about(write(name, content));
  }

  std::filesystem::path folder_;
};

using ObjFile = MeshFile;

/// For PLY, OFF and STL, which a build without CGAL refuses.
class FileThroughCgal : public MeshFile {
 protected:
  void SetUp() override {
    MeshFile::SetUp();
    if (complaint("probe.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").find("build with CGAL") !=
        std::string::npos) {
      GTEST_SKIP() << "built without CGAL";
    }
  }
};

const std::string square_vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

double total_area(const TriangleMesh& mesh) {
  const std::vector<double> areas = triangle_areas(mesh);
  return std::accumulate(areas.begin(), areas.end(), 0.0);
}

TEST_F(ObjFile, GivesVerticesAndTrianglesInTheOrderOfTheFile) {
  const TriangleMesh mesh = read("cloth.obj", "# a comment\n" + square_vertices + "f 1 2 3\nf 3 4 1 # another\n");
  EXPECT_EQ(mesh.vertices, (std::vector<Vector3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 3, 0}}));
  EXPECT_TRUE(mesh.corner_uv.empty());
  EXPECT_TRUE(mesh.groups.empty());
  EXPECT_EQ(mesh.cells_x, 0);
}

TEST_F(ObjFile, KeepsAllDigitsOfCoordinates) {
  const TriangleMesh mesh = read("cloth.obj", "v 0.1 -1.2345678901234567e-3 +2.5\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(mesh.vertices[0], Vector3(0.1, -1.2345678901234567e-3, 2.5));
}

TEST_F(ObjFile, UnderstandsWindowsLinesByteOrderMarksContinuationsWeightsAndColours) {
  const TriangleMesh mesh = read("CLOTH.OBJ",
                                 "\xEF\xBB\xBFv 0 0 0 1\r\nv 1 0 0 .5 .5 .5\r\nv 1 1 0\r\n\r\nvn 0 0 1\r\ns "
                                 "off\r\nusemtl red\r\nf 1//1 \\\r\n2//1 3//1");
  EXPECT_EQ(mesh.vertices.size(), 3u);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST_F(ObjFile, CountsNegativeIndicesBackFromTheLastVertexSoFar) {
  const TriangleMesh mesh = read("cloth.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -1 1 3\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {3, 0, 2}}));
}

TEST_F(ObjFile, TakesTextureVerticesAsCornerUv) {
  const TriangleMesh mesh = read(
      "cloth.obj", square_vertices + "vt 0 0\nvt 2 0\nvt 2 3\nvt 0 3\nf 1/1 2/2/1 3/3\nf 1/1 3/3 4/-1\nvn 0 0 1\n");
  ASSERT_EQ(mesh.corner_uv.size(), 2u);
  EXPECT_EQ(mesh.corner_uv[0], (std::array<Vector2, 3>{Vector2(0, 0), Vector2(2, 0), Vector2(2, 3)}));
  EXPECT_EQ(mesh.corner_uv[1], (std::array<Vector2, 3>{Vector2(0, 0), Vector2(2, 3), Vector2(0, 3)}));
}

TEST_F(ObjFile, HasNoUvWhereOnlySomeFacesHaveIt) {
  EXPECT_TRUE(read("cloth.obj", square_vertices + "vt 0 0\nf 1/1 2/1 3/1\nf 1 3 4\n").corner_uv.empty());
}

TEST_F(ObjFile, PutsTheVerticesOfFacesIntoTheirGroupsAndObjects) {
  const TriangleMesh mesh = read("cloth.obj", square_vertices + "o sheet\ng hem lower\nf 3 1 2\ng upper\nf 1 3 4\n");
  EXPECT_EQ(mesh.groups, (std::map<std::string, std::vector<int>>{
                             {"hem", {0, 1, 2}}, {"lower", {0, 1, 2}}, {"sheet", {0, 1, 2, 3}}, {"upper", {0, 2, 3}}}));
}

TEST_F(ObjFile, LeavesAGroupAtAnEmptyGroupRecord) {
  const TriangleMesh mesh = read("cloth.obj", square_vertices + "g hem\nf 1 2 3\ng\nf 1 3 4\n");
  EXPECT_EQ(mesh.groups, (std::map<std::string, std::vector<int>>{{"hem", {0, 1, 2}}}));
}

TEST_F(ObjFile, CutsPolygonsIntoFansWithTheirUv) {
  const TriangleMesh mesh = read("cloth.obj", square_vertices + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh.corner_uv[1], (std::array<Vector2, 3>{Vector2(0, 0), Vector2(1, 1), Vector2(0, 1)}));
}

TEST_F(ObjFile, FansADentedQuadFromItsDent) {
  const TriangleMesh mesh =
      read("cloth.obj", "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 2 3 4 1\n");  // the dent is at (1, 1)
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{2, 3, 0}, {2, 0, 1}}));
  EXPECT_DOUBLE_EQ(total_area(mesh), 4.0);
}

TEST_F(ObjFile, FansAPolygonWithAStraightCornerSoThatNoTriangleIsEmpty) {
  const TriangleMesh mesh = read("cloth.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n");
  EXPECT_NO_THROW(validate(mesh, "cloth.obj"));
  EXPECT_DOUBLE_EQ(total_area(mesh), 4.0);
}

TEST_F(ObjFile, CutsASlightlyTwistedQuadAndRefusesAFoldedOne) {
  EXPECT_EQ(read("cloth.obj", "v 0 0 0\nv 1 0 0\nv 1 1 .1\nv 0 1 0\nf 1 2 3 4\n").triangles.size(), 2u);
  EXPECT_EQ(complaint("cloth.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3 4\n"),
            "cloth.obj:5: a face with 4 corners that no fan of triangles fits (dented, twisted or degenerate)");
  EXPECT_EQ(complaint("cloth.obj", square_vertices + "f 1 2 2 3\n"),
            "cloth.obj:5: a face with 4 corners that no fan of triangles fits (dented, twisted or degenerate)");
}

TEST_F(ObjFile, NamesTheLineOfWhatIsWrong) {
  EXPECT_EQ(complaint("c.obj", "v 0 0 0\nv 1 0\n"), "c.obj:2: a vertex with 2 numbers, expected 3 coordinates");
  EXPECT_EQ(complaint("c.obj", "v 0 0 0x\n"), "c.obj:1: \"0x\" is not a number");
  EXPECT_EQ(complaint("c.obj", "v 0 nan 0\n"), "c.obj:1: \"nan\" is not a finite number");
  EXPECT_EQ(complaint("c.obj", "v 0 0 -inf\n"), "c.obj:1: \"-inf\" is not a finite number");
  EXPECT_EQ(complaint("c.obj", "v 0 0 1e999\n"), "c.obj:1: \"1e999\" is not a finite number");
  EXPECT_EQ(complaint("c.obj", square_vertices + "f 1 2\n"), "c.obj:5: a face with 2 corners, expected at least 3");
  EXPECT_EQ(complaint("c.obj", square_vertices + "f 1 2 x\n"), "c.obj:5: \"x\" is not an index");
  EXPECT_EQ(complaint("c.obj", square_vertices + "f 1 2 3.5\n"), "c.obj:5: \"3.5\" is not an index");
  EXPECT_EQ(complaint("c.obj", square_vertices + "vt nan 0\n"), "c.obj:5: \"nan\" is not a finite number");
  EXPECT_EQ(complaint("c.obj", square_vertices + "curv2 1 2\n"), "c.obj:5: unknown record \"curv2\"");
}

TEST_F(ObjFile, NamesIndicesOutOfRange) {
  EXPECT_EQ(complaint("c.obj", square_vertices + "f 1 2 0\n"), "c.obj:5: index 0, expected indices to start at 1");
  EXPECT_EQ(complaint("c.obj", square_vertices + "f 1 2 5\n"), "c.obj:5: vertex 5 is out of range, the file has 4");
  EXPECT_EQ(complaint("c.obj", square_vertices + "f 1 2 -5\n"), "c.obj:5: index -5 reaches back beyond the first of 4");
  EXPECT_EQ(complaint("c.obj", square_vertices + "f 1 2 99999999999\n"), "c.obj:5: \"99999999999\" is not an index");
  EXPECT_EQ(complaint("c.obj", square_vertices + "f 1 2 -2147483648\n"),
            "c.obj:5: index -2147483648 reaches back beyond the first of 4");
  EXPECT_EQ(complaint("c.obj", square_vertices + "vt 0 0\nf 1/1 2/1 3/2\n"),
            "c.obj:6: texture vertex 2 is out of range, the file has 1");
  EXPECT_EQ(complaint("c.obj", square_vertices + "vt 0 0\nf 1/1 2 3/1\n"),
            "c.obj:6: a face with 3 corners, of which 2 have a texture vertex, expected all or none");
}

TEST_F(ObjFile, AllowsAFaceBeforeItsVertices) {
  EXPECT_EQ(read("cloth.obj", "f 1 2 3\n" + square_vertices).triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST_F(MeshFile, SaysWhichFileIsMissingEmptyUnknownOrNotAFile) {
  EXPECT_EQ(complaint_about(folder_ / "none.obj"), "none.obj: no such file");
  EXPECT_EQ(complaint("c.obj", ""), "c.obj: the file is empty");
  EXPECT_EQ(complaint("c.stl", ""), "c.stl: the file is empty");
  EXPECT_EQ(complaint("c.obj", "# nothing\n"), "c.obj: the file has no faces");
  EXPECT_EQ(complaint("c.fbx", "?"), "c.fbx: unknown kind of mesh file \".fbx\", expected .obj, .ply, .off or .stl");
  std::filesystem::create_directory(folder_ / "d.obj");
  EXPECT_EQ(complaint_about(folder_ / "d.obj"), "d.obj: not a file");
}

// ---- PLY, OFF, STL -------------------------------------------------------------------------------------------------

const std::string square_off = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
const std::string ply_end =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
    "property list uchar int vertex_indices\nend_header\n";
const std::string square_ply = "ply\nformat ascii 1.0\n" + ply_end + "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

std::string facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 1\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c + "\nendloop\nendfacet\n";
}
std::string square_stl() {
  return "solid square\n" + facet("0 0 0", "1 0 0", "1 1 0") + facet("0 0 0", "1 1 0", "0 1 0") + "endsolid square\n";
}

template <class Number>
void append(std::string& bytes, Number value) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string binary_ply() {
  std::string bytes = "ply\nformat binary_little_endian 1.0\n" + ply_end;
  for (const int x : {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}) append(bytes, static_cast<float>(x));
  for (const std::array<int, 3>& face : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
    append(bytes, std::uint8_t{3});
    for (const int v : face) append(bytes, std::int32_t{v});
  }
  return bytes;
}

std::string binary_stl(const std::string& header = "binary") {
  std::string bytes = header + std::string(80 - header.size(), ' ');
  append(bytes, std::uint32_t{2});
  for (const auto& face : {std::array{0, 0, 0, 1, 0, 0, 1, 1, 0}, std::array{0, 0, 0, 1, 1, 0, 0, 1, 0}}) {
    for (int k = 0; k < 3; ++k) append(bytes, k == 2 ? 1.0f : 0.0f);
    for (const int x : face) append(bytes, static_cast<float>(x));
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

TEST_F(FileThroughCgal, GivesTheSameSquareInEveryFormat) {
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.off", square_off},
      {"b.ply", square_ply},
      {"c.ply", binary_ply()},
      {"d.stl", square_stl()},
      {"e.stl", binary_stl()},
      {"f.STL", binary_stl("solid but binary")},
      {"g.off", square_off.substr(0, square_off.size() - 1)}};
  for (const auto& [name, content] : files) {
    SCOPED_TRACE(name);
    const TriangleMesh mesh = read(name, content);
    EXPECT_EQ(mesh.vertices, (std::vector<Vector3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_NO_THROW(validate(mesh, name));
  }
}

TEST_F(FileThroughCgal, CutsPolygons) {
  EXPECT_EQ(read("c.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n").triangles,
            (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(complaint("c.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3\n"),
            "c.off: face 0: a face with 4 corners that no fan of triangles fits (dented, twisted or degenerate)");
}

TEST_F(FileThroughCgal, RefusesATruncatedFileWhereverItIsCut) {
  const std::vector<std::pair<std::string, std::string>> files = {{"a.off", square_off},
                                                                  {"b.ply", square_ply},
                                                                  {"c.ply", binary_ply()},
                                                                  {"d.stl", square_stl()},
                                                                  {"e.stl", binary_stl()}};
  for (const auto& [name, content] : files) {
    const bool is_binary = name[0] == 'c' || name[0] == 'e';
    // The last line of a text may lose its newline or, in STL, part of the name behind "endsolid" unnoticed.
    const std::size_t noticed = is_binary ? content.size() : content.size() - (name[0] == 'd' ? 8 : 2);
    for (std::size_t size = noticed - 1; size > 4; size -= 5) {
      const std::string message = complaint(name, content.substr(0, size));
      EXPECT_TRUE(message.starts_with(name + ":"))
          << name << " cut to " << size << " of " << content.size() << " bytes: " << message;
      EXPECT_EQ(message.find('\n'), std::string::npos);
    }
  }
}

TEST_F(FileThroughCgal, NamesIndicesOutOfRangeInPly) {
  const std::string good = "3 0 2 3\n";
  const std::string head = square_ply.substr(0, square_ply.size() - good.size());
  EXPECT_EQ(complaint("c.ply", head + "3 0 2 4\n"),
            "c.ply: face 1: vertex 4 is out of range, the file has 4 (counted from 0)");
  EXPECT_EQ(complaint("c.ply", head + "3 0 2 -1\n"),
            "c.ply: face 1: vertex -1 is out of range, the file has 4 (counted from 0)");
  EXPECT_EQ(complaint("c.ply", head + "2 0 2\n"), "c.ply: face 1: a face with 2 corners, expected at least 3");
}

TEST_F(FileThroughCgal, RefusesIndicesOutOfRangeInOff) {
  EXPECT_EQ(complaint("c.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
            "c.off: not a complete off file (truncated, malformed or of another kind)");
}

TEST_F(FileThroughCgal, RefusesAnOffHeaderThatPromisesMoreThanTheFileHolds) {
  const std::string message = "c.off: the header promises more vertices or faces than the file can hold";
  EXPECT_EQ(complaint("c.off", "OFF\n2000000000 1 0\n0 0 0\n"), message);
  EXPECT_EQ(complaint("c.off", "OFF\n1 2000000000 0\n0 0 0\n"), message);
  EXPECT_EQ(complaint("c.off", "OFF\n-1 1 0\n0 0 0\n"), "c.off: no header of an OFF file");
}

TEST_F(FileThroughCgal, RefusesBinaryOffBecauseItWouldBeMisread) {
  EXPECT_EQ(complaint("c.off", "OFF BINARY\n" + std::string(100, '\0')),
            "c.off: binary OFF files are not read, save it as text");
}

TEST_F(FileThroughCgal, NamesTheLineOfABadPlyHeader) {
  const std::string unplaced = "not a record of a PLY header, or one in the wrong place";
  const std::string start = "ply\nformat ascii 1.0\n";
  const auto without = [](const std::string& line) {
    return std::string(square_ply).erase(square_ply.find(line), line.size());
  };
  EXPECT_EQ(complaint("c.ply", "plyx\n"), "c.ply:1: expected \"ply\"");
  EXPECT_TRUE(complaint("c.ply", "ply\nformat utf8 1.0\n").starts_with("c.ply:2: expected \"format\""));
  EXPECT_EQ(complaint("c.ply", start + "element vertex 1\n"), "c.ply:4: the header has no end");
  EXPECT_EQ(complaint("c.ply", start + "\nend_header\n"), "c.ply:3: blank line in the header");
  EXPECT_EQ(complaint("c.ply", start + "property float x\n"), "c.ply:3: " + unplaced);
  EXPECT_EQ(complaint("c.ply", start + "element vertex 1\nproperty float128 x\n"), "c.ply:4: " + unplaced);
  EXPECT_EQ(complaint("c.ply", start + "element vertex 1\nproperty list float int x\n"), "c.ply:4: " + unplaced);
  EXPECT_EQ(complaint("c.ply", start + "element vertex 2000000000\n"),
            "c.ply:3: \"2000000000\" is not a number of items that fits in the file");
  EXPECT_EQ(complaint("c.ply", start + "element vertex -1\n"),
            "c.ply:3: \"-1\" is not a number of items that fits in the file");
  EXPECT_EQ(complaint("c.ply", without("property float z\n")),
            "c.ply:8: the vertices have no property z of type float or double");
  EXPECT_EQ(complaint("c.ply", without("property list uchar int vertex_indices\n")),
            "c.ply:8: the faces have no list vertex_indices or vertex_index of type int or uint");
}

TEST_F(FileThroughCgal, SkipsWhatElseAPlyFileHolds) {
  const TriangleMesh mesh =
      read("c.ply",
           "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 3\nproperty double x\nproperty double y\nproperty "
           "double z\n"
           "property uchar red\nelement face 1\nproperty list uchar uint vertex_index\nproperty float quality\nelement "
           "edge 1\n"
           "property int vertex1\nproperty int vertex2\nend_header\n0.1 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2 0.5\n0 1\n");
  EXPECT_EQ(mesh.vertices, (std::vector<Vector3>{{0.1, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST_F(FileThroughCgal, RefusesCoordinatesThatAreNotFinite) {
  for (const std::string value : {"nan", "inf", "1e999"}) {
    SCOPED_TRACE(value);
    EXPECT_NE(complaint("c.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 " + value + " 0\n3 0 1 2\n"), "");
    EXPECT_NE(complaint("c.stl", "solid s\n" + facet("0 0 0", "1 0 0", "0 " + value + " 0") + "endsolid s\n"), "");
  }
  std::string ply = binary_ply();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  ply.replace(ply.find("end_header\n") + 11 + 3 * sizeof nan, sizeof nan, reinterpret_cast<const char*>(&nan),
              sizeof nan);
  EXPECT_EQ(complaint("c.ply", ply), "c.ply: vertex 1: coordinates are not finite");
}

TEST_F(FileThroughCgal, RefusesAFileOfAnotherKind) {
  for (const std::string name : {"c.off", "c.ply", "c.stl"}) {
    EXPECT_TRUE(complaint(name, square_vertices + "f 1 2 3\nf 1 3 4\n").starts_with(name + ":")) << name;
  }
}

}  // namespace
}  // namespace taut
