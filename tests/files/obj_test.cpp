#include "files/obj.h"

#include <cstring>
#include <limits>
#include <sstream>

#include "files/atomic_file.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using ObjTest = FilesTest;

TEST_F(ObjTest, CoordinatesGiveTheSameDoublesBack) {
  Vector positions(9);
  positions << 0.1 + 0.2, -0.0, 1e-310, 1.0 / 3, std::numeric_limits<double>::max(), -2, 1e22, 123456789.123456789,
      5e-324;
  write_obj(path("a.obj"), positions, {{0, 1, 2}, {2, 1, 0}});
  std::istringstream lines(read_bytes(path("a.obj")));
  std::string word, number;
  for (Index i = 0; i < positions.size(); ++i) {
    if (i % 3 == 0) lines >> word;
    ASSERT_EQ(word, "v");
    lines >> number;
    const double value = std::strtod(number.c_str(), nullptr);
    EXPECT_EQ(std::memcmp(&value, &positions[i], sizeof value), 0) << number;
  }
  lines >> std::ws;
  const std::string rest(std::istreambuf_iterator<char>(lines), {});
  EXPECT_EQ(rest, "f 1 2 3\nf 3 2 1\n");
}

TEST_F(ObjTest, RefusesWhatAnObjCannotHold) {
  Vector positions = Vector::Zero(9);
  EXPECT_EQ(message_of<std::invalid_argument>([&] {
              write_obj(path("a.obj"), positions, {{0, 1, 3}});
            }),
            "write_obj: triangles[0] names vertex 3, expected one of the 3 vertices");
  positions[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_obj(path("a.obj"), positions, {}), std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(path("a.obj")));
}

}  // namespace
}  // namespace taut
