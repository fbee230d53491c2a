#include "files/vtu.h"

#include <gmock/gmock.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include "files/atomic_file.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using VtuTest = FilesTest;

// As ParaView writes them in the data mode Ascii.
const std::string ascii_file =
    R"(<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian" compressor="x">
  <UnstructuredGrid><Piece NumberOfPoints="3" NumberOfCells="1">
    <PointData Scalars="id">
      <DataArray type="Int64" Name="id" format="ascii"> 1 2 3 </DataArray>
    </PointData>
    <Points>
      <DataArray type="Float32" Name="Points" NumberOfComponents="3" format="ascii" RangeMin="0" RangeMax="2.5">
        0 0 0 1 0 0
        0.5 1e-3 -2.25
        <InformationKey name="L2_NORM_RANGE" location="vtkDataArray" length="2"></InformationKey>
      </DataArray>
    </Points>
    <Cells>
      <DataArray type="Int64" Name="connectivity" format="ascii">0 1 2</DataArray>
      <DataArray type="Int64" Name="offsets" format="ascii">3</DataArray>
      <DataArray type="UInt8" Name="types" format="ascii">5</DataArray>
    </Cells>
  </Piece></UnstructuredGrid>
</VTKFile>
)";

Frame sample() {
  Frame frame;
  frame.time = 0.1 + 0.2;
  frame.positions.resize(12);
  frame.positions << 0, -0.0, 1e-310, 0.1, 1.0 / 3, 1e300, 1, 1, 1, -std::numeric_limits<double>::infinity(),
      std::bit_cast<double>(0x7ff80000deadbeefull), 5;
  frame.triangles = {{0, 1, 2}, {2, 1, 3}};
  frame.point_fields = {{"velocity", 3, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 0.7}},
                        {"a < \"b\" & c>\n", 1, {1, 2, 3, -0.0}}};
  frame.cell_fields = {{"sigma_max", 1, {1.05, std::numeric_limits<double>::quiet_NaN()}},
                       {"tension", 2, {1, 2, 3, 4}}};
  return frame;
}

bool same_bits(const double* a, const double* b, std::size_t count) {
  return std::memcmp(a, b, count * sizeof(double)) == 0;
}

void expect_same(const std::vector<Field>& a, const std::vector<Field>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].components, b[i].components);
    ASSERT_EQ(a[i].values.size(), b[i].values.size());
    EXPECT_TRUE(same_bits(a[i].values.data(), b[i].values.data(), a[i].values.size())) << a[i].name;
  }
}

TEST_F(VtuTest, EveryBitOfAFrameComesBack) {
  const Frame written = sample();
  write_vtu(path("f.vtu"), written);
  const Frame read = read_vtu(path("f.vtu"));
  EXPECT_EQ(read.time, written.time);
  EXPECT_EQ(read.triangles, written.triangles);
  ASSERT_EQ(read.positions.size(), written.positions.size());
  EXPECT_TRUE(same_bits(read.positions.data(), written.positions.data(), 12));
  expect_same(read.point_fields, written.point_fields);
  expect_same(read.cell_fields, written.cell_fields);
}

TEST_F(VtuTest, AnEmptyFrameComesBack) {
  write_vtu(path("f.vtu"), Frame{});
  const Frame read = read_vtu(path("f.vtu"));
  EXPECT_EQ(read.positions.size(), 0);
  EXPECT_TRUE(read.triangles.empty() && read.point_fields.empty() && read.cell_fields.empty());
}

TEST_F(VtuTest, ReadsBackTheTypesThatVtkExpects) {
  write_vtu(path("f.vtu"), sample());
  const std::string bytes = read_bytes(path("f.vtu"));
  for (const char* part :
       {"<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"appended\"",
        "<DataArray type=\"Int64\" Name=\"connectivity\"", "<DataArray type=\"Int64\" Name=\"offsets\"",
        "<DataArray type=\"UInt8\" Name=\"types\"", "header_type=\"UInt64\"",
        "Name=\"a &lt; &quot;b&quot; &amp; c&gt;&#10;\"", "<Piece NumberOfPoints=\"4\" NumberOfCells=\"2\">"}) {
    EXPECT_NE(bytes.find(part), std::string::npos) << part;
  }
}

TEST_F(VtuTest, TheBlocksFollowEachOtherInTheOrderOfTheirDeclarations) {
  write_vtu(path("f.vtu"), sample());
  const std::string bytes = read_bytes(path("f.vtu"));
  const std::size_t data = bytes.find("\n_") + 2;
  std::uint64_t expected = 0;
  int arrays = 0;
  for (std::size_t at = 0; (at = bytes.find("offset=\"", at)) != bytes.npos; ++arrays) {
    at += std::string_view("offset=\"").size();
    EXPECT_EQ(std::stoull(bytes.substr(at, 20)), expected);
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data() + data + expected, sizeof size);
    expected += sizeof size + size;
  }
  EXPECT_EQ(arrays, 9);
  EXPECT_EQ(bytes.substr(data + expected), "\n</AppendedData>\n</VTKFile>\n");
}

TEST_F(VtuTest, RefusesFieldsThatDoNotFit) {
  const auto refusal = [this](auto change) {
    Frame frame = sample();
    change(frame);
    return message_of<std::invalid_argument>([&] { write_vtu(path("f.vtu"), frame); });
  };
  EXPECT_EQ(refusal([](Frame& f) { f.point_fields[0].values.pop_back(); }),
            "write_vtu: point_fields 'velocity' must hold 12 values, got 11");
  EXPECT_EQ(refusal([](Frame& f) { f.cell_fields[1].components = 0; }),
            "write_vtu: cell_fields 'tension' must have at least 1 component, got 0");
  EXPECT_EQ(refusal([](Frame& f) { f.cell_fields[1].name = "sigma_max"; }),
            "write_vtu: cell_fields holds 'sigma_max' twice");
  EXPECT_EQ(refusal([](Frame& f) { f.point_fields[0].name = ""; }),
            "write_vtu: point_fields holds a field without a name");
  EXPECT_EQ(refusal([](Frame& f) { f.triangles[1][2] = 4; }),
            "write_vtu: triangles[1] names vertex 4, expected one of the 4 vertices");
  EXPECT_EQ(refusal([](Frame& f) { f.positions.conservativeResize(11); }),
            "write_vtu: positions must hold 3 coordinates a vertex, got 11 numbers");
  EXPECT_FALSE(std::filesystem::exists(path("f.vtu")));
}

TEST_F(VtuTest, ACutInTheDataIsNoticed) {
  write_vtu(path("f.vtu"), sample());
  const auto tail = std::string_view("\n</AppendedData>\n</VTKFile>\n").size();
  for (std::size_t size = std::filesystem::file_size(path("f.vtu")) - tail; size-- > 0;) {
    std::filesystem::resize_file(path("f.vtu"), size);
    EXPECT_THROW(read_vtu(path("f.vtu")), FileError) << size;
  }
}

TEST_F(VtuTest, ADamagedByteGivesAnErrorOrAFrameButNeverACrash) {
  write_vtu(path("f.vtu"), sample());
  int refused = 0;
  for (std::size_t i = 0; i < std::filesystem::file_size(path("f.vtu")); ++i) {
    flip(path("f.vtu"), i, 0x15);
    try {
      const Frame frame = read_vtu(path("f.vtu"));
      EXPECT_EQ(frame.positions.size(), 12);
      EXPECT_EQ(frame.triangles.size(), 2u);
    } catch (const FileError&) {
      ++refused;
    }
    flip(path("f.vtu"), i, 0x15);
  }
  EXPECT_GT(refused, 300);
}

TEST_F(VtuTest, OtherFilesAreRefused) {
  write_atomically(path("f.vtu"), "v 0 0 0\n");
  EXPECT_EQ(message_of<FileError>([&] { read_vtu(path("f.vtu")); }), path("f.vtu").string() + ": is not a VTU file");
  const auto refusal = [this](const std::string& text) {
    write_atomically(path("f.vtu"), text);
    return message_of<FileError>([&] { read_vtu(path("f.vtu")); });
  };
  EXPECT_THAT(refusal("<VTKFile type=\"PolyData\"></VTKFile>"), testing::HasSubstr("not an UnstructuredGrid"));
  std::string text = ascii_file;
  text.replace(text.find("ascii", text.find("Name=\"Points\"")), 5, "binary");
  EXPECT_THAT(refusal(text), testing::HasSubstr("array 'Points' is stored as 'binary', expected ascii or raw"));
  text = ascii_file;
  text.replace(text.find("0 0 0"), 5, "0 0 x");
  EXPECT_THAT(refusal(text), testing::HasSubstr("array 'Points' holds something that is not a number"));
  text.replace(text.find("0 0 x"), 5, "0 0  ");
  EXPECT_THAT(refusal(text), testing::HasSubstr("array 'Points' holds 8 numbers, expected 9"));
}

TEST_F(VtuTest, ReadsTheAsciiFilesOfOtherPrograms) {
  write_atomically(path("f.vtu"), ascii_file);
  const Frame frame = read_vtu(path("f.vtu"));
  EXPECT_EQ(frame.positions, (Vector(9) << 0, 0, 0, 1, 0, 0, 0.5, 1e-3, -2.25).finished());
  EXPECT_EQ(frame.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(frame.point_fields.at(0).values, (std::vector<double>{1, 2, 3}));
}

TEST_F(VtuTest, ThePvdListsTimesExactly) {
  write_pvd(path("a.pvd"), {{0, "frames/0.vtu"}, {0.1 + 0.2, "frames/a & b.vtu"}});
  EXPECT_EQ(read_bytes(path("a.pvd")),
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
            "byte_order=\"LittleEndian\">\n<Collection>\n"
            "<DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"frames/0.vtu\"/>\n"
            "<DataSet timestep=\"0.30000000000000004\" group=\"\" part=\"0\" file=\"frames/a &amp; b.vtu\"/>\n"
            "</Collection>\n</VTKFile>\n");
}

}  // namespace
}  // namespace taut
