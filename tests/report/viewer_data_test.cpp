#include "report/viewer_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "problems/build.h"
#include "problems/read_scene.h"
#include "report/run_report.h"
#include "study/run.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class ViewerData : public FilesTest {
 protected:
  Scene scene(const std::string& name, Overrides overrides) const {
    return read_scene(std::string(TAUT_CATALOGUE) + "/" + name + ".json", overrides);
  }
  void solve(const Scene& made, double max_seconds = 0) const {
    RunOptions options;
    options.folder = path("run");
    options.threads = 1;
    options.max_seconds = max_seconds;
    run(made, options);
  }
  /// A run of the hanging cloth with 5 x 5 vertices and 12 steps.
  Scene solved(Overrides more = {}) {
    Overrides overrides{{"bodies.cloth.mesh.grid.cells", "[4,4]"}, {"time.steps", "12"}, {"output.every", "1"}};
    overrides.insert(overrides.end(), more.begin(), more.end());
    const Scene made = scene("hanging_cloth", overrides);
    solve(made);
    return made;
  }
  static std::vector<int> steps_of(const Json& data) {
    std::vector<int> steps;
    for (const Json& frame : data["frames"]) steps.push_back(frame["step"]);
    return steps;
  }
  static bool has_field(const Json& data, const std::string& id) {
    return std::any_of(data["fields"].begin(), data["fields"].end(),
                       [&](const Json& field) { return field["id"] == id; });
  }
};

TEST_F(ViewerData, KeepsAsManyFramesAsAllowedEvenlyWithTheFirstAndTheLast) {
  const Scene made = solved();
  EXPECT_EQ(steps_of(viewer_data(path("run"), made)).size(), 13u);
  const Json four = viewer_data(path("run"), made, {.frames = 4});
  EXPECT_THAT(steps_of(four), testing::ElementsAre(0, 4, 8, 12));
  EXPECT_THAT(four["note"].get<std::string>(), HasSubstr("4 of the run's 13 frames"));
  EXPECT_THAT(steps_of(viewer_data(path("run"), made, {.vertices = 75})), testing::ElementsAre(0, 6, 12));
  EXPECT_THAT(steps_of(viewer_data(path("run"), made, {.vertices = 1})), testing::ElementsAre(0, 12));
}

TEST_F(ViewerData, HasStretchTensionLayersAndTheLastPicture) {
  const Json data = viewer_data(path("run"), solved({{"time.steps", "40"}}));
  EXPECT_EQ(data["vertices"], 25);
  EXPECT_TRUE(has_field(data, "sigma_max"));
  EXPECT_TRUE(has_field(data, "tension"));
  EXPECT_EQ(data["layers"][0]["name"], "cloth");
  EXPECT_EQ(data["layers"][0]["count"], 32);
  EXPECT_EQ(data["pins"].size(), 2u);
  EXPECT_TRUE(data["picture"].is_string());
  EXPECT_EQ(data["up"], Json({0, 0, 1}));
}

TEST_F(ViewerData, FramesWithoutFieldsGiveTheStretchAllTheSame) {
  const Json with = viewer_data(path("run"), solved({{"time.steps", "40"}}));
  const Json data = viewer_data(path("run"), solved({{"time.steps", "40"}, {"output.format", "obj"}}));
  EXPECT_TRUE(has_field(data, "sigma_max"));
  EXPECT_FALSE(has_field(data, "tension"));
  EXPECT_EQ(data["fields"][0]["values"], with["fields"][0]["values"]);
}

TEST_F(ViewerData, NoFramesNoViewer) {
  EXPECT_TRUE(viewer_data(path("run"), solved({{"output.format", "none"}})).is_null());
  EXPECT_FALSE(run_report(path("run"), "taut solve").contains("viewer"));
}

TEST_F(ViewerData, AFrameOfAnotherMeshIsRefused) {
  const Scene made = solved();
  std::ofstream(path("run") / "frames" / "hanging_cloth_00013.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_THAT(message_of<FileError>([&] { viewer_data(path("run"), made); }),
              HasSubstr("the 25 vertices of the scene"));
}

TEST_F(ViewerData, ViolationsOfLimitsThatCannotBeMetAreShownWithTheirTriangles) {
  const Scene made = scene("infeasible_pins", {});
  solve(made);
  const Json data = viewer_data(path("run"), made);
  const auto& worst = data["worst"];
  ASSERT_FALSE(worst.empty());
  const std::string field = worst[0]["field"];
  EXPECT_THAT(field, HasSubstr("violation_"));
  EXPECT_TRUE(has_field(data, field));
  EXPECT_GT(worst[0]["value"], 0.0);
  EXPECT_EQ(worst[0]["triangles"].size(), 1u);
}

TEST_F(ViewerData, ThickShellsHaveABottomAndATop) {
  const Scene made = scene("yoga_mat", {{"time.steps", "1"}});
  solve(made, 1);
  const Json layers = viewer_data(path("run"), made)["layers"];
  ASSERT_GE(layers.size(), 2u);
  const auto named = [&](const std::string& end) {
    return std::any_of(layers.begin(), layers.end(),
                       [&](const Json& layer) { return layer["name"].get<std::string>().ends_with(end); });
  };
  EXPECT_TRUE(named(", bottom"));
  EXPECT_TRUE(named(", top"));
}

TEST_F(ViewerData, OtherPositionsAreADistanceWhereTheyDiffer) {
  const Scene made = scene("hanging_cloth", {{"bodies.cloth.mesh.grid.cells", "[4,4]"}});
  Frame start;
  start.positions = build_model(made)->start();
  Vector moved = start.positions;
  moved[2] += 0.25;  // the first vertex, upwards
  const std::vector<ViewerFrame> frames{{0, [&] { return start; }, "start"}, {1, [&] { return start; }, "start"}};
  const Json data = viewer_data(made, frames,
                                {{"same", [&](int) { return start.positions; }},
                                 {"moved", [&](int step) { return step == 1 ? std::optional(moved) : std::nullopt; }}});
  EXPECT_THAT(steps_of(data), testing::ElementsAre(0, 1));
  EXPECT_FALSE(has_field(data, "distance_same"));
  ASSERT_TRUE(has_field(data, "distance_moved"));
  EXPECT_NEAR(data["fields"].back()["most"], 0.25, 1e-12);
  EXPECT_EQ(data["fields"].back()["least"], 0);
  EXPECT_TRUE(data["picture"].is_null());
}

TEST_F(ViewerData, ARunsReportHasAPointForEveryStep) {
  solved();
  const Json report = run_report(path("run"), "taut solve x");
  EXPECT_EQ(report["command"], "taut solve x");
  for (const Json& chart : report["charts"]) {
    for (const Json& series : chart["series"]) EXPECT_EQ(series["points"].size(), 12u) << chart["id"] << series["name"];
  }
  EXPECT_EQ(report["charts"][0]["id"], "residuals");
  EXPECT_EQ(report["settings"]["time"]["steps"], 12);
}

}  // namespace
}  // namespace taut
