#include "files/svg_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

#include "files/atomic_file.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

class SvgPictureTest : public FilesTest {
 protected:
  /// A unit square in the plane z = `height`, as two triangles.
  static Vector square(double height) {
    Vector positions(12);
    positions << 0, 0, height, 1, 0, height, 1, 1, height, 0, 1, height;
    return positions;
  }
  Picture picture() const {
    Picture picture;
    picture.positions = square(0);
    picture.triangles = &triangles_;
    picture.triangle_values = {1.0, 1.1};
    picture.low = 1;
    picture.high = 1.1;
    picture.title = "A <square> & more";
    picture.value_name = "stretch";
    return picture;
  }
  std::string drawn(const Picture& picture) const {
    write_svg(path("a.svg"), picture);
    return read_bytes(path("a.svg"));
  }
  /// The centres x, y, x, y, ... of the marks, which tell where vertices are on the page.
  std::vector<double> marks(const Picture& picture) const {
    std::istringstream lines(drawn(picture));
    std::vector<double> centers;
    double x = 0, y = 0;
    int consumed = 0;
    for (std::string line; std::getline(lines, line); consumed = 0) {
      std::sscanf(line.c_str(), "<circle cx=\"%lf\" cy=\"%lf\" r=\"4\"/>%n", &x, &y, &consumed);
      if (consumed > 0) centers.insert(centers.end(), {x, y});
    }
    return centers;
  }
  std::vector<Triangle> triangles_{{0, 1, 2}, {0, 2, 3}};
};

long count(const std::string& text, const std::string& part) {
  long found = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++found;
  return found;
}

void expect_finite(const std::string& svg) {
  for (const char* number :
       {"\"nan", "\"-nan", "\"inf", "\"-inf", " nan", " -nan", " inf", " -inf", "Mnan", "M-nan", "lnan", "l-nan"}) {
    EXPECT_EQ(count(svg, number), 0) << number;
  }
}

TEST_F(SvgPictureTest, DrawsEachTriangleSphereAndMarkOnce) {
  Picture p = picture();
  p.spheres = {{{0.5, 0.5, -1}, 0.5}};
  p.marked_vertices = {0, 3};
  const std::string svg = drawn(p);
  EXPECT_EQ(count(svg, "z\" fill="), 2);
  EXPECT_EQ(count(svg, "url(#ball)\"/>"), 1);
  EXPECT_EQ(count(svg, "r=\"4\"/>"), 2);
  EXPECT_NE(svg.find("A &lt;square&gt; &amp; more"), std::string::npos);
  EXPECT_TRUE(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
}

TEST_F(SvgPictureTest, TheLegendShowsTheScaleAndWhatIsThere) {
  Picture p = picture();
  p.triangle_values = {1.01, 1.125};
  const std::string svg = drawn(p);
  for (const char* label :
       {">1.000<", ">1.025<", ">1.050<", ">1.075<", ">1.100<", ">stretch<", ">here 1.01 to 1.125<"}) {
    EXPECT_NE(svg.find(label), std::string::npos) << label;
  }
}

TEST_F(SvgPictureTest, LegendNumbersOfANarrowScaleDiffer) {
  Picture p = picture();
  p.low = 0.999;
  p.high = 1.001;
  const std::string svg = drawn(p);
  for (const char* label : {">0.9990<", ">0.9995<", ">1.0000<", ">1.0010<"})
    EXPECT_NE(svg.find(label), std::string::npos) << label;
}

TEST_F(SvgPictureTest, TheSceneFillsItsFrameWhereverItIs) {
  Picture p = picture();
  p.view_from = Vector3::UnitZ();
  for (const double scale : {1e-6, 1.0, 1e6}) {
    p.positions = scale * square(3);
    p.marked_vertices = {0, 2};
    const auto corners = marks(p);
    ASSERT_EQ(corners.size(), 4u);
    const double side = std::max(std::abs(corners[2] - corners[0]), std::abs(corners[3] - corners[1]));
    EXPECT_NEAR(side, 760, 0.1) << scale;
  }
}

TEST_F(SvgPictureTest, UpInTheSceneIsUpOnThePage) {
  Picture p = picture();
  p.positions << 0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0, 1;
  p.marked_vertices = {0, 1};
  auto ends = marks(p);
  EXPECT_NEAR(ends[0], ends[2], 0.02);
  EXPECT_GT(ends[1], ends[3] + 100);
  p.up = -Vector3::UnitZ();
  ends = marks(p);
  EXPECT_LT(ends[1], ends[3] - 100);
}

TEST_F(SvgPictureTest, TheDefaultEyeLooksFromAboveAndFromTheFront) {
  // Of four points around the origin and one above it, the nearest to the eye is drawn last.
  Picture p = picture();
  const auto last_drawn = [&](const Vector3& a, const Vector3& b) {
    p.positions.resize(6);
    p.positions << a, b;
    triangles_ = {{0, 0, 0}, {1, 1, 1}};
    p.triangle_values = {0, 1};
    p.low = 0;
    p.high = 1;
    const std::string svg = drawn(p);
    const std::size_t at = svg.rfind("l0 0 0 0z\" fill=\"");
    return svg.compare(at + 17, 2, "#4") < 0 ? 1 : 0;
  };
  EXPECT_EQ(last_drawn({0, 0, 1}, {0, 0, -1}), 0);
  EXPECT_EQ(last_drawn({0, 1, 0}, {0, -1, 0}), 1);
  EXPECT_EQ(last_drawn({1, 0, 0}, {-1, 0, 0}), 0);
}

TEST_F(SvgPictureTest, ASphereHidesWhatIsBehindItsCentre) {
  Picture p = picture();
  p.view_from = Vector3::UnitZ();
  p.spheres = {{{0.5, 0.5, 1}, 0.5}};
  std::string svg = drawn(p);
  EXPECT_GT(svg.find("url(#ball)\"/>"), svg.rfind("z\" fill="));
  p.spheres[0].center.z() = -1;
  svg = drawn(p);
  EXPECT_LT(svg.find("url(#ball)\"/>"), svg.find("z\" fill="));
}

TEST_F(SvgPictureTest, DegenerateScenesGiveFiniteNumbers) {
  Picture p = picture();
  p.positions.setConstant(7);
  p.low = p.high = 1;
  p.triangle_values = {1, std::numeric_limits<double>::quiet_NaN()};
  p.view_from = Vector3::UnitZ();
  expect_finite(drawn(p));
  const std::vector<Triangle> none;
  Picture nothing;
  nothing.triangles = &none;
  expect_finite(drawn(nothing));
}

TEST_F(SvgPictureTest, AFineSheetStaysSmall) {
  const int cells = 128;
  Picture p = picture();
  triangles_.clear();
  p.positions.resize(3 * (cells + 1) * (cells + 1));
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      p.positions.segment<3>(3 * (j * (cells + 1) + i)) =
          Vector3(i / 128.0, j / 128.0, 0.05 * std::sin(0.1 * (i + 2 * j)));
      const int a = j * (cells + 1) + i, b = a + cells + 1;
      if (i < cells && j < cells) triangles_.insert(triangles_.end(), {{a, a + 1, b}, {a + 1, b + 1, b}});
    }
  }
  p.triangle_values.assign(triangles_.size(), 1.03);
  EXPECT_LT(drawn(p).size(), 85 * triangles_.size());
}

TEST_F(SvgPictureTest, RefusesWhatDoesNotFit) {
  const auto refusal = [this](auto change) {
    Picture p = picture();
    change(p);
    return message_of<std::invalid_argument>([&] { drawn(p); });
  };
  EXPECT_EQ(refusal([](Picture& p) { p.triangles = nullptr; }), "write_svg: triangles must not be null");
  EXPECT_EQ(refusal([](Picture& p) { p.triangle_values.pop_back(); }),
            "write_svg: triangle_values must hold 2 values, got 1");
  EXPECT_EQ(refusal([](Picture& p) { p.marked_vertices = {4}; }),
            "write_svg: marked_vertices names vertex 4, expected one of the 4 vertices");
  EXPECT_EQ(refusal([](Picture& p) { p.positions[0] = std::numeric_limits<double>::infinity(); }),
            "write_svg: positions must be finite numbers");
}

}  // namespace
}  // namespace taut
