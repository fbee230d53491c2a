#include "report/compare_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "study/compare.h"
#include "study/compare_job.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

class CompareReport : public FilesTest {
 protected:
  /// Three steps of the tiny scene by two solvers.
  Comparison compared() const {
    tiny_scene(path("."));
    CompareOptions options;
    options.problems = {path("tiny.json")};
    options.choice.solvers = {"augmented_lagrangian", "multiplier_loop"};
    options.steps = 3;
    options.folder = path("compared");
    options.worker = {TAUT_PROGRAM, "compare-worker"};
    return compare(options);
  }
  Json report_of(const Comparison& comparison) const {
    return compare_report(comparison, "taut compare tiny.json", path("compared"));
  }
  static std::vector<int> steps_of(const Json& report) {
    std::vector<int> steps;
    for (const Json& frame : report["viewer"]["frames"]) steps.push_back(frame["step"]);
    return steps;
  }
};

TEST_F(CompareReport, ShowsTheReferenceAndTheDistancesOfTheOthers) {
  const Json report = report_of(compared());
  EXPECT_THAT(steps_of(report), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(report["viewer"]["note"].get<std::string>(), HasSubstr("solved it"));
  EXPECT_THAT(report["viewer"]["fields"].dump(), HasSubstr("distance_"));
  ASSERT_EQ(report["tables"][0]["rows"].size(), 2u);
}

/// Such a step has no positions that could be drawn, and its file is not even opened; everything else is shown.
TEST_F(CompareReport, StepsThatEndedAtNoPlaceAreLeftOut) {
  Comparison comparison = compared();
  ProblemComparison& problem = comparison.problems.front();
  const auto lose = [&](EntryRun& run, int step) {
    run.trials.at(static_cast<std::size_t>(step - 1)).residuals.finite = false;
    ASSERT_TRUE(std::filesystem::remove(step_file(path("compared") / run.folder / solutions_folder, step)));
  };
  lose(problem.trajectory, 2);
  for (EntryRun& run : problem.entries) lose(run, 3);
  const Json report = report_of(comparison);
  EXPECT_THAT(steps_of(report), ElementsAre(0, 1, 3));
  EXPECT_EQ(report["tables"][0]["rows"].size(), 2u);
}

}  // namespace
}  // namespace taut
