// Runs `taut solve --report` and `taut compare --report` as a shell would; tests/report/page_test.mjs opens what they
// write.
#include "report/html_report.h"
#include "tests/cli/runs_program.h"

namespace taut {
namespace {

using testing::HasSubstr;

class ReportOptions : public RunsProgram {
 protected:
  void SetUp() override {
    if (!has_report_page()) GTEST_SKIP() << "built without node and npm";
  }
  std::vector<std::string> solve(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"solve", "hanging_cloth", "--set", "bodies.cloth.mesh.grid.cells=[4,4]",
                                       "--set", "time.steps=3"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(ReportOptions, WithoutOutTheRunIsKeptBesideThePage) {
  const Outcome outcome = taut(solve({"--report", folder("report")}));
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, HasSubstr("report: " + folder("report") + "/index.html ("));
  EXPECT_TRUE(std::filesystem::exists(path("report/run/summary.json")));
  EXPECT_TRUE(std::filesystem::exists(path("report/residuals.svg")));
  const std::string page = content(path("report/index.html"));
  EXPECT_THAT(page,
              HasSubstr("taut solve hanging_cloth --set 'bodies.cloth.mesh.grid.cells=[4,4]' --set time.steps=3"));
  EXPECT_EQ(taut(solve({"--report", folder("report")})).code, 0) << "a second time into the same directory";
}

TEST_F(ReportOptions, AStepThatIsNotSolvedIsReportedAllTheSame) {
  const Outcome outcome = taut(solve({"--set", "solver.max_outer=2", "--set", "solver.tolerance.stationarity=1e-300",
                                      "--report", folder("report"), "--quiet"}));
  EXPECT_EQ(outcome.code, 3) << outcome.error;
  EXPECT_EQ(outcome.out + outcome.error, "") << "quiet";
  EXPECT_THAT(content(path("report/index.html")), HasSubstr("0 of 3 steps solved"));
}

TEST_F(ReportOptions, WhatCannotBeWrittenIsRefusedBeforeAnythingIsSolved) {
  expect_refused(solve({"--png"}), "--png needs --report DIR");
  std::ofstream(path("file")) << "mine";
  expect_refused(solve({"--report", folder("file")}), "is not a directory");
  EXPECT_EQ(content(path("file")), "mine");
  expect_refused({"compare", "hanging_cloth", "--solvers", "augmented_lagrangian", "--png"},
                 "--png needs --report DIR");
}

TEST_F(ReportOptions, PngNeedsAPainter) {
  ::setenv("PATH", folder("empty").c_str(), 1);  // this test is a process of its own
  expect_refused(solve({"--report", folder("report"), "--png"}), "--png needs rsvg-convert, which is not installed");
  EXPECT_FALSE(std::filesystem::exists(path("report")));
}

}  // namespace
}  // namespace taut
