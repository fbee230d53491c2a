#include "study/chart_knob.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/files/temporary_folder.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

class ChartKnob : public FilesTest {
 protected:
  /// bdf2, eight steps of 0.02 s, 4 x 4 cells.
  Scene scene(const Overrides& overrides = {}) const { return tiny_scene(path("."), overrides); }
  std::vector<KnobValue> values(const std::string& text, const Overrides& overrides = {}) const {
    return values_of(parse_knob(text), scene(overrides));
  }
  std::string refusal(const std::string& text, const Overrides& overrides = {}) const {
    return message_of<InputError>([&] { values(text, overrides); });
  }
};

TEST_F(ChartKnob, StepsKeepTheEndTime) {
  const std::vector<KnobValue> steps = values("step=0.04,0.01");
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_THAT(steps[0].overrides, ElementsAre(Pair("time.step", "0.04"), Pair("time.steps", "4")));
  EXPECT_THAT(steps[1].overrides, ElementsAre(Pair("time.step", "0.01"), Pair("time.steps", "16")));
  EXPECT_THAT(refusal("step=0.03"), HasSubstr("found 0.03, allowed: what divides 0.16"));
}

TEST_F(ChartKnob, StaticStepsAreSharesOfTheLoad) {
  const std::vector<KnobValue> steps = values("step=0.25", {{"time", R"({"integrator": "static", "steps": 8})"}});
  EXPECT_THAT(steps[0].overrides, ElementsAre(Pair("time.steps", "4")));
}

TEST_F(ChartKnob, MeshesAreFactorsOnTheCellsOfEveryGrid) {
  const std::vector<KnobValue> meshes = values("mesh=0.5,1,2");
  ASSERT_EQ(meshes.size(), 3u);
  EXPECT_EQ(meshes[0].label, "2x2");
  EXPECT_EQ(meshes[0].number, 2);  // cells twice as wide
  EXPECT_THAT(meshes[2].overrides, ElementsAre(Pair("bodies.cloth.mesh.grid.cells", "[8,8]")));
  EXPECT_THAT(refusal("mesh=0.3"), HasSubstr("are no whole cells"));
  EXPECT_EQ(values("mesh").front().label, "1x1");  // down to a quarter where that leaves whole cells
}

TEST_F(ChartKnob, TolerancesAreAllThree) {
  EXPECT_THAT(values("tolerance=1e-4")[0].overrides, ElementsAre(Pair("solver.tolerance.stationarity", "0.0001"),
                                                                 Pair("solver.tolerance.feasibility", "0.0001"),
                                                                 Pair("solver.tolerance.complementarity", "0.0001")));
  EXPECT_GE(values("tolerance").size(), 4u);
  EXPECT_THAT(refusal("tolerance=1e-4,tight"), HasSubstr("found tight, allowed: numbers above 0"));
  EXPECT_THAT(refusal("tolerance=-1"), HasSubstr("found -1"));
}

TEST_F(ChartKnob, ModelsAreFilesOrOverrides) {
  const std::vector<KnobValue> models = values("model=other.json,gravity=[0,0,-1];time.steps=2");
  ASSERT_EQ(models.size(), 2u);
  EXPECT_EQ(models[0].problem, "other.json");
  EXPECT_THAT(models[1].overrides, ElementsAre(Pair("gravity", "[0,0,-1]"), Pair("time.steps", "2")));
  const std::vector<KnobValue> named = values(R"(model=thin:other.json,falls:gravity={"x":1})");
  EXPECT_EQ(named[0].label, "thin");
  EXPECT_EQ(named[0].problem, "other.json");
  EXPECT_EQ(named[1].label, "falls");
  EXPECT_THAT(named[1].overrides, ElementsAre(Pair("gravity", R"({"x":1})")));
}

TEST_F(ChartKnob, AnyOtherNameIsAKeyAndNeedsValues) {
  EXPECT_THAT(values("constraints.limit.max=1.05,1.1")[1].overrides, ElementsAre(Pair("constraints.limit.max", "1.1")));
  EXPECT_THAT(refusal("constraints.limit.max"), HasSubstr("--vary constraints.limit.max: expected tolerance"));
  EXPECT_THAT(refusal("model"), HasSubstr("expected"));
}

TEST_F(ChartKnob, KnowsWhichValuesPoseTheSameProblem) {
  for (const char* same : {"tolerance", "penalty", "solver.max_newton=10,20", "constraints.limit.form=matrix"})
    EXPECT_TRUE(keeps_the_problem(parse_knob(same))) << same;
  for (const char* other : {"step", "mesh", "integrator", "constraints.limit.max=1.1"})
    EXPECT_FALSE(keeps_the_problem(parse_knob(other))) << other;
}

TEST_F(ChartKnob, IntegratorsAreForDynamicProblems) {
  EXPECT_GE(values("integrator").size(), 3u);
  EXPECT_THAT(refusal("integrator", {{"time", R"({"integrator": "static", "steps": 8})"}}), HasSubstr("is static"));
}

}  // namespace
}  // namespace taut
