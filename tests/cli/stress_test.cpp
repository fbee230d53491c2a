// Runs `taut stress` as a shell would; tests/study/stress_test.cpp has crashes, hangs and lies.
#include <nlohmann/json.hpp>

#include "tests/cli/runs_program.h"

namespace taut {
namespace {

using testing::HasSubstr;

class StressCommand : public RunsProgram {
 protected:
  /// Two entries, of which one has a refused input and both a value that nobody solves.
  Outcome stress(std::vector<std::string> more) {
    more.insert(more.begin(),
                {"stress", "--quick", "--entry", "penalty,not_finite", "--method", "augmented_lagrangian,nlopt_lbfgs"});
    return taut(more);
  }
};

TEST_F(StressCommand, WritesTheReportTheTableAndAHeatMapPerEntry) {
  const Outcome outcome = stress({"--out", folder("out"), "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  const nlohmann::json report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report, nlohmann::json::parse(content(path("out") / "report.json")));
  ASSERT_EQ(report["heat_maps"].size(), 2u);
  const nlohmann::json& penalty = report["heat_maps"][0];
  EXPECT_EQ(penalty["id"], "penalty");
  EXPECT_EQ(penalty["methods"].size(), 1u) << "NLopt has no penalty";
  ASSERT_EQ(penalty["cells"][0].size(), penalty["values"].size());
  EXPECT_EQ(penalty["cells"][0][0]["outcome"], "solved");
  const nlohmann::json& refused = report["heat_maps"][1]["cells"][0][0];
  EXPECT_EQ(refused["outcome"], "honest_failure");
  EXPECT_THAT(refused["text"].get<std::string>(), HasSubstr("allowed: a number"));
  EXPECT_THAT(content(path("out") / "penalty.svg"), HasSubstr("solver.penalty"));
  EXPECT_THAT(content(path("out") / "stress.md"), HasSubstr("| penalty | 1 | 1e10 | all |"));
  EXPECT_EQ(stress({"--against", (path("out") / "frontiers.json").string(), "--quiet"}).code, 0);
}

TEST_F(StressCommand, ACellsCommandSolvesItsProblem) {
  ASSERT_EQ(stress({"--out", folder("out"), "--quiet"}).code, 0);
  const auto report = nlohmann::json::parse(content(path("out") / "report.json"));
  const std::string command = report["heat_maps"][0]["cells"][0][0]["command"];
  ASSERT_EQ(command.substr(0, 5), "taut ");
  EXPECT_EQ(std::system((TAUT_PROGRAM + command.substr(4) + " --quiet").c_str()), 0) << command;
}

TEST_F(StressCommand, AFrontierThatMovedBackExitsWithThree) {
  std::ofstream(path("stored.json"))
      << R"({"not_finite": {"values": "E=NaN E=1e999 mesh E=1e300 g=1e200", "outcomes": {"nlopt_lbfgs": "shhhh"}}})";
  const Outcome outcome = stress({"--against", folder("stored.json"), "--quiet"});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.error, HasSubstr("worse: not_finite: nlopt_lbfgs solves nothing, stored: up to E=NaN"));
}

TEST_F(StressCommand, WrongUsageExitsWithTwo) {
  expect_refused({"stress", "--method", "magic", "--quiet"}, "--method: found magic");
  expect_refused({"stress", "--method", "magic", "--quiet"}, "multiplier_loop");
  expect_refused({"stress", "--entry", "magic", "--quiet"}, "snap_through");
  expect_refused({"stress", "--max-seconds", "0"}, "--max-seconds");
  expect_refused({"stress", "--against", "none.json"}, "none.json");
}

}  // namespace
}  // namespace taut
