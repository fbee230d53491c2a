#include "study/chart_errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "problems/build.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

StartingPoints points(const std::string& body, const std::vector<Vector3>& at) {
  StartingPoints start;
  start.bodies.push_back({.name = body, .first_vertex = 0, .vertices = static_cast<int>(at.size())});
  start.positions.resize(3 * static_cast<Index>(at.size()));
  for (std::size_t k = 0; k < at.size(); ++k) start.positions.segment<3>(3 * static_cast<Index>(k)) = at[k];
  return start;
}

TEST(CommonPoints, AreThoseOfOneBodyAtOnePlace) {
  const StartingPoints coarse = points("cloth", {{0, 0, 0}, {1, 0, 0}});
  const StartingPoints fine = points("cloth", {{1 + 1e-9, 0, 0}, {0.5, 0, 0}, {0, 0, 0}});
  const auto common = common_points({coarse, fine}, 1);
  EXPECT_THAT(common[0], ElementsAre(BodyPoint{0, 0}, BodyPoint{1, 1}));
  EXPECT_THAT(common[1], ElementsAre(BodyPoint{2, 2}, BodyPoint{0, 0}));
  EXPECT_THAT(common_points({coarse, points("other", {{0, 0, 0}})}, 1)[0], IsEmpty());
}

class ChartErrors : public FilesTest {
 protected:
  Scene scene(const Overrides& overrides = {}) const { return tiny_scene(path("."), overrides); }
  StartingPoints start(const Overrides& overrides) const {
    const auto model = build_model(scene(overrides));
    return {model->bodies, model->start()};
  }
};

TEST_F(ChartErrors, NestedGridsShareTheVerticesOfTheCoarsest) {
  const auto common = common_points({start({}), start({{"bodies.cloth.mesh.grid.cells", "[8,8]"}})}, 1.4);
  EXPECT_THAT(common[0], SizeIs(25));
  EXPECT_THAT(common[1], SizeIs(25));
}

TEST_F(ChartErrors, ASheetIsWhereTheMiddleOfAThickShellIs) {
  const StartingPoints sheet = start({}),
                       shell = start({{"bodies.cloth.model", "thick_shell"},
                                      {"bodies.cloth.membrane", "null"},
                                      {"bodies.cloth.bending", "null"},
                                      {"bodies.cloth.thickness", "0.01"},
                                      {"bodies.cloth.material",
                                       R"({"law": "stvk", "young_modulus": 1e4, "poisson_ratio": 0.2})"}});
  const auto common = common_points({sheet, shell}, 1.4);
  ASSERT_THAT(common[0], SizeIs(25));
  for (std::size_t k = 0; k < 25; ++k) {
    const auto [bottom, top] = common[1][k];
    const Vector3 low = shell.positions.segment<3>(3 * bottom), high = shell.positions.segment<3>(3 * top);
    EXPECT_NEAR((high - low).norm(), 0.01, 1e-12);
    EXPECT_NEAR(((low + high) / 2 - sheet.positions.segment<3>(3 * common[0][k][0])).norm(), 0, 1e-12);
  }
  EXPECT_THAT(common_points({shell, shell}, 1.4)[0], SizeIs(75)) << "two surfaces and the middle";
}

TEST_F(ChartErrors, ProbesAreMeasuredAsTheFileSays) {
  const Scene with_probes = scene({{"output.probes", R"({
      "length": {"quantity": "z", "body": "cloth", "select": {"corners": ["x0y0"]},
                 "expected": {"value": -2, "absolute": 0.1, "source": "first"}},
      "share": {"quantity": "z", "body": "cloth", "select": {"corners": ["x1y0"]},
                "expected": {"value": -2, "relative": 0.1, "source": "second"}},
      "unknown": {"quantity": "z", "body": "cloth", "select": {"corners": ["x0y0"]}}})"}});
  const ErrorMeasure measure = error_measure(ErrorKind::probe, with_probes, 4);
  EXPECT_THAT(measure.probes, ElementsAre("length", "share"));
  EXPECT_THAT(measure.source, HasSubstr("first"));
  // By hand: 1 m off is 1/4 of the scene's 4 m, and 1/2 of the value.
  EXPECT_EQ(measure(Vector2(-1, -2), *measure.expected), 0.25);
  EXPECT_EQ(measure(Vector2(-2, -1), *measure.expected), 0.5);
}

TEST_F(ChartErrors, PositionsAreMeasuredByTheFarthestVertexOverTheScene) {
  const ErrorMeasure measure = error_measure(ErrorKind::position, scene(), 10);
  Vector a = Vector::Zero(6), b = Vector::Zero(6);
  b[0] = 1;
  b[4] = 3;
  b[5] = 4;
  EXPECT_EQ(measure(a, b), 0.5);
}

TEST_F(ChartErrors, EnergiesAreMeasuredByTheirMagnitudes) {
  const ErrorMeasure measure = error_measure(ErrorKind::energy, scene(), 1);
  EXPECT_EQ(measure(Vector2(-1, 5), Vector2(-2, 4)), 0.25);
}

TEST_F(ChartErrors, ProbesNeedAProbe) {
  EXPECT_THAT(message_of<InputError>([&] { error_measure(ErrorKind::probe, scene(), 1); }),
              HasSubstr("/output/probes: found none"));
}

}  // namespace
}  // namespace taut
