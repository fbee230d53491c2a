#include "core/pack.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace taut {
namespace {

TEST(Pack, ArcTangentIsThatOfTheStandardLibraryInEveryOctant) {
  std::vector<double> numbers{0.0, 1e-300, 1e-9, 0.1, 0.41, 0.65, 0.66, 0.67, 1.0, 1.5, 7.0, 1e12};
  for (std::size_t k = numbers.size(); k-- > 1;) numbers.push_back(-numbers[k]);
  for (const double y : numbers) {
    for (const double x : numbers) {
      if (y == 0 && x == 0) continue;
      const double expected = std::atan2(y, x);
      const Pack angle = arc_tangent(Pack(y), Pack(x));
      for (int lane = 0; lane < Pack::size; ++lane)
        EXPECT_NEAR(angle[lane], expected, 4e-16 * std::abs(expected)) << y << ", " << x;
    }
  }
}

TEST(Pack, LanesDoNotKnowOfEachOther) {
  const Pack a = lanes_of([](int lane) { return lane == 2 ? std::numeric_limits<double>::quiet_NaN() : lane - 1.0; });
  const Pack b = select(a < Pack(0.0), -a, square_root(a)) / Pack(2.0);
  EXPECT_EQ(b[0], 0.5);
  EXPECT_EQ(b[1], 0);
  EXPECT_TRUE(std::isnan(b[2]));
  EXPECT_EQ(b[3], std::sqrt(2.0) / 2);
}

TEST(Pack, QuadsRepeatTheLastElement) {
  EXPECT_EQ(quads(8), 2);
  EXPECT_EQ(quads(9), 3);
  EXPECT_EQ(element_of(2, 0, 9), 8);
  EXPECT_EQ(element_of(2, 3, 9), 8);
}

}  // namespace
}  // namespace taut
