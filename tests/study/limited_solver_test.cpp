#include "study/limited_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "study/run.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

using testing::HasSubstr;

class LimitedRun : public FilesTest {
 protected:
  static RunSummary solved_within(long linear_solves, const Scene& scene) {
    RunOptions options;
    options.threads = 1;
    options.max_linear_solves = linear_solves;
    return run(scene, options);
  }
};

TEST_F(LimitedRun, EndsWhereItsLinearSolvesAreUsedUp) {
  const Scene scene = tiny_scene(path(""));
  const RunSummary whole = solved_within(0, scene);
  ASSERT_EQ(whole.status, Status::solved);
  const long half = whole.counts.linear_solves / 2;
  const RunSummary part = solved_within(half, scene);
  EXPECT_EQ(part.status, Status::iteration_limit);
  EXPECT_EQ(part.counts.linear_solves, half);
  EXPECT_LT(part.steps_done, whole.steps_done);
  EXPECT_THAT(part.message, HasSubstr("used up"));
}

TEST_F(LimitedRun, IsTheSameWhereTheyAreEnough) {
  const Scene scene = tiny_scene(path(""));
  const RunSummary whole = solved_within(0, scene), enough = solved_within(1000000, scene);
  EXPECT_EQ(enough.status, Status::solved);
  EXPECT_EQ(enough.counts.linear_solves, whole.counts.linear_solves);
  EXPECT_EQ(enough.objective, whole.objective);
}

/// A load step that is halved again and again must not be taken for a limit point.
TEST_F(LimitedRun, SaysSoInAStaticProblemToo) {
  const Scene scene = read_scene(std::string(TAUT_CATALOGUE) + "/stretched_strip.json", {{"time.halvings", "6"}});
  const RunSummary summary = solved_within(20, scene);
  EXPECT_EQ(summary.status, Status::iteration_limit);
  EXPECT_LE(summary.counts.linear_solves, 20);
}

}  // namespace
}  // namespace taut
