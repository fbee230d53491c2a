#include "study/residual_estimate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "problems/read_scene.h"
#include "study/run.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

using testing::HasSubstr;

class ResidualEstimates : public FilesTest {
 protected:
  static Scene scene(const std::string& name, const Overrides& overrides) {
    return read_scene(std::string(TAUT_CATALOGUE) + "/" + name + ".json", overrides);
  }
  /// A quarter of a clamped plate, 0.01 m thick and 0.5 m wide, under a pressure in N/m2.
  static Scene plate(int cells, double pressure, const std::string& tolerance = "1e-6") {
    const std::string n = std::to_string(cells);
    return scene("validation/plate_clamped_100",
                 {{"bodies.shell.mesh.grid.cells", "[" + n + "," + n + "]"},
                  {"loads.load.force_per_area", "[0,0," + std::to_string(pressure) + "]"},
                  {"solver.tolerance.stationarity", tolerance}});
  }
  StoredRun solved(const Scene& scene) {
    RunOptions options;
    options.folder = path("run_" + std::to_string(++runs_));
    options.threads = 1;
    EXPECT_EQ(run(scene, options).status, Status::solved) << scene.name;
    return read_stored_run(options.folder);
  }
  /// What the finer model answers, by the residual of the coarse one.
  ResidualEstimate estimate(const std::string& quantity, const Scene& coarse, const Scene& finer) {
    return residual_estimate(solved(coarse), finer, Observer(parse_quantity(quantity), finer), 1);
  }
  std::string refusal(const std::string& quantity, const Scene& coarse, const Scene& finer) {
    const ResidualEstimate found = estimate(quantity, coarse, finer);
    EXPECT_FALSE(found.answer);
    return found.why;
  }

 private:
  int runs_ = 0;
};

TEST_F(ResidualEstimates, AreExactWhereTheProblemIsLinear) {
  const Scene coarse = plate(4, 1), finer = plate(8, 1);  // (w / t)^2, what is not linear, is about 1e-6
  const StoredRun below = solved(coarse), above = solved(finer);
  for (const char* quantity : {"probe:w", "probe:moment", "displacement", "shape"}) {
    const Observer observer(parse_quantity(quantity), finer);
    const ResidualEstimate found = residual_estimate(below, finer, observer, 1);
    ASSERT_TRUE(found.answer) << quantity << ": " << found.why;
    const Answer truth = observer(above).value();
    const double difference = distance(observer(below).value(), truth);
    EXPECT_GT(difference, 1e-3 * truth.magnitude) << quantity;
    EXPECT_LT(distance(*found.answer, truth), 1e-5 * difference) << quantity;
    EXPECT_EQ(found.linear_solves, 2);
  }
}

TEST_F(ResidualEstimates, LeaveWhatTheContractionSaysWhereItIsNot) {
  const Scene coarse = plate(4, 500), finer = plate(8, 500);  // w / t = 0.5
  const StoredRun below = solved(coarse), above = solved(finer);
  const Observer observer(parse_quantity("shape"), finer);
  const ResidualEstimate found = residual_estimate(below, finer, observer, 1);
  ASSERT_TRUE(found.answer) << found.why;
  const Answer truth = observer(above).value();
  const double difference = distance(observer(below).value(), truth);
  EXPECT_GT(found.contraction, 1e-4) << "or the plate is not nonlinear";
  EXPECT_LT(distance(*found.answer, truth), found.contraction * difference);
}

TEST_F(ResidualEstimates, TellWhatALooseToleranceLeaves) {
  const Scene tight = plate(8, 500, "1e-8"), loose = plate(8, 500, "1e-1");
  const StoredRun before = solved(loose), after = solved(tight);
  const Observer observer(parse_quantity("displacement"), tight);
  const ResidualEstimate found = residual_estimate(before, tight, observer, 1);
  ASSERT_TRUE(found.answer) << found.why;
  const Answer truth = observer(after).value();
  const double left = distance(observer(before).value(), truth);
  EXPECT_GT(left, 1e-6 * truth.magnitude);
  EXPECT_LT(distance(*found.answer, truth), 0.1 * left);
}

TEST_F(ResidualEstimates, AreRefusedFarFromTheFinerAnswer) {
  const auto elastica = [](const char* cells) {
    return scene("validation/elastica_10", {{"bodies.shell.mesh.grid.cells", cells}});
  };
  EXPECT_THAT(refusal("probe:z", elastica("[5,1]"), elastica("[10,1]")), HasSubstr("not positive definite"));
  const auto rolled = [](const char* cells) {
    return scene("validation/roll_up_10", {{"bodies.shell.mesh.grid.cells", cells}});
  };
  EXPECT_THAT(refusal("probe:x", rolled("[20,1]"), rolled("[40,1]")), HasSubstr("does not contract"));
}

TEST_F(ResidualEstimates, AreRefusedWhereALimitHoldsOrWouldBeViolated) {
  const auto strip = [](const char* cells, const char* most) {
    return scene("stretched_strip", {{"bodies.strip.mesh.grid.cells", cells}, {"constraints.limit.max", most}});
  };
  EXPECT_THAT(refusal("tension", strip("[2,20]", "1.05"), strip("[4,40]", "1.05")), HasSubstr("is active"));
  const ResidualEstimate free = estimate("tension", strip("[2,20]", "2"), strip("[4,40]", "2"));
  EXPECT_TRUE(free.answer) << free.why;
  EXPECT_THAT(refusal("tension", strip("[2,20]", "2"), strip("[4,40]", "1.05")), HasSubstr("would be violated"));
}

TEST_F(ResidualEstimates, AreOfStaticAnswersOnly) {
  const Scene cloth = tiny_scene(path(""));
  EXPECT_THAT(refusal("shape", cloth, cloth), HasSubstr("not static"));
  const auto cantilever = [](const char* cells) {
    return scene("validation/frequencies_cantilever_10", {{"bodies.shell.mesh.grid.cells", cells}});
  };
  EXPECT_THAT(refusal("frequency:1", cantilever("[5,1]"), cantilever("[10,1]")), HasSubstr("needs its mode"));
}

}  // namespace
}  // namespace taut
