// Runs the built program as a shell would.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/cli/runs_program.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

class ProgramTest : public RunsProgram {
 protected:
  const std::vector<std::string> small_{"solve", "hanging_cloth", "--set",     "bodies.cloth.mesh.grid.cells=[6,6]",
                                        "--set", "time.steps=5",  "--threads", "1"};
  std::vector<std::string> small(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = small_;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(ProgramTest, SolvingExitsWithZeroAndSaysWhatWasReached) {
  const Outcome outcome = taut(small({"--out", folder("out")}));
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("hanging_cloth: solved, 5 of 5 steps solved"));
  EXPECT_THAT(outcome.out, HasSubstr("stationarity"));
  EXPECT_THAT(outcome.out, HasSubstr(folder("out")));
  EXPECT_THAT(outcome.error, HasSubstr("hanging_cloth: 5/5"));
  EXPECT_TRUE(fs::exists(path("out") / "summary.json"));
}

TEST_F(ProgramTest, JsonIsTheSummaryAndNothingElse) {
  const Outcome outcome = taut(small({"--out", folder("out"), "--json"}));
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out, content(path("out") / "summary.json"));
  EXPECT_EQ(Json::parse(outcome.out)["status"], "solved");
  EXPECT_NE(Json::parse(outcome.out)["version"], "");
}

TEST_F(ProgramTest, WithoutAnOutputDirectoryNothingIsWritten) {
  EXPECT_EQ(taut(small({"--json"})).code, 0);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(path("."))) ++files;
  EXPECT_EQ(files, 2u) << "only this test's stdout and stderr";
}

TEST_F(ProgramTest, QuietPrintsNothing) {
  const Outcome outcome = taut(small({"--quiet"}));
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out + outcome.error, "");
}

TEST_F(ProgramTest, TheFormatOfFramesCanBeChosen) {
  EXPECT_EQ(taut(small({"--out", folder("out"), "--format", "obj", "--set", "output.pictures=0"})).code, 0);
  EXPECT_TRUE(fs::exists(path("out") / "frames" / "hanging_cloth_00005.obj"));
  EXPECT_FALSE(fs::exists(path("out") / "hanging_cloth.pvd"));
  EXPECT_FALSE(fs::exists(path("out") / "pictures"));
}

TEST_F(ProgramTest, WrongUsageExitsWithTwoAndOneLine) {
  expect_refused({}, "taut --help");
  expect_refused({"fly"}, "fly");
  expect_refused({"solve"}, "PROBLEM");
  expect_refused({"list"}, "taut list --help");
  expect_refused({"list", "unicorns"}, "unicorns");
  expect_refused(small({"--fast"}), "--fast");
  expect_refused(small({"--format", "stl"}), "stl");
  expect_refused(small({"--threads", "-1"}), "--threads");
  expect_refused(small({"--max-seconds", "0"}), "--max-seconds");
  expect_refused(small({"--set", "nonsense"}), "expected KEY=VALUE");
  expect_refused(small({"--resume"}), "--resume needs --out");
}

TEST_F(ProgramTest, WrongInputExitsWithTwoAndOneLine) {
  expect_refused({"solve", "no_such_problem"}, "no such file");
  expect_refused({"solve", folder("missing.json")}, "no such file");
  expect_refused(small({"--set", "time.stepz=1"}), "/time/stepz: unknown key");
  expect_refused(small({"--set", "time.steps=many"}), "/time/steps");
  expect_refused(small({"--set", "constraints.corners.select.vertices=[99999]"}), "/constraints/corners");
  std::ofstream(path("broken.json")) << "{ \"format\": 1,\n \"time\": ";
  expect_refused({"solve", folder("broken.json")}, "broken.json");
  std::ofstream(path("nan.json")) << "{ \"format\": 1, \"time\": { \"integrator\": \"static\", \"steps\": NaN } }";
  expect_refused({"solve", folder("nan.json")}, "nan.json");
}

TEST_F(ProgramTest, AnInputThatCannotBeBuiltLeavesNoDirectoryBehind) {
  expect_refused(small({"--set", "constraints.corners.select={\"vertices\":[99999]}", "--out", folder("out")}),
                 "/constraints/corners");
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(ProgramTest, AForeignDirectoryExitsWithTwo) {
  fs::create_directory(path("mine"));
  std::ofstream(path("mine") / "thesis.txt") << "irreplaceable";
  expect_refused(small({"--out", folder("mine")}), "holds no run of taut");
  expect_refused(small({"--out", folder("mine") + "/thesis.txt"}), "is not a directory");
  expect_refused(small({"--out", folder("mine") + "/thesis.txt/deeper"}), "cannot be created");
}

TEST_F(ProgramTest, ResumingAnotherProblemsDirectoryExitsWithTwo) {
  EXPECT_EQ(taut(small({"--out", folder("out")})).code, 0);
  expect_refused(small({"--out", folder("out"), "--resume", "--set", "constraints.limit.max=1.2"}), "another problem");
  const Outcome again = taut(small({"--out", folder("out"), "--resume"}));
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.out, HasSubstr("5 of 5 steps solved"));
}

TEST_F(ProgramTest, InfeasibleLimitsExitWithThreeAndAreWritten) {
  // Half of the pull, a stretch of 1.1, is already more than the limit of 1.05 allows.
  const Outcome outcome = taut({"solve", "infeasible_pins", "--set", "bodies.sheet.mesh.grid.cells=[6,6]", "--set",
                                "time.steps=2", "--set", "solver.on_failure=stop", "--out", folder("out")});
  EXPECT_EQ(outcome.code, 3) << outcome.error;
  const Json summary = Json::parse(content(path("out") / "summary.json"));
  EXPECT_EQ(summary["status"], "infeasible");
  EXPECT_EQ(summary["steps"]["done"], 1) << "it stops at the step that is not solved";
  EXPECT_NEAR(summary["worst_elements"][0]["violation"], 0.05, 1e-3);
  EXPECT_THAT(outcome.out, HasSubstr("infeasible"));
  EXPECT_THAT(outcome.out, HasSubstr("triangle "));
  EXPECT_THAT(outcome.error, HasSubstr("step 1: infeasible"));
  EXPECT_TRUE(fs::exists(path("out") / "frames" / "infeasible_pins_00001.vtu"));
}

TEST_F(ProgramTest, TimeThatIsOverExitsWithThree) {
  const Outcome outcome = taut(small({"--max-seconds", "1e-6", "--json"}));
  EXPECT_EQ(outcome.code, 3);
  EXPECT_EQ(Json::parse(outcome.out)["status"], "time_limit");
}

TEST_F(ProgramTest, SignalsEndARunWith130AndResumingEndsItWithTheSameBits) {
  const auto long_run = [&](const std::string& out) {
    return small({"--set", "time.steps=60", "--format", "none", "--set", "output.pictures=0", "--out", folder(out)});
  };
  EXPECT_EQ(taut(long_run("whole")).code, 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    fs::remove_all(path("parts"));
    const pid_t process = start(long_run("parts"));
    for (int i = 0; i < 5000 && content(path("parts") / "steps.jsonl").empty(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ::kill(process, signal);
    const Outcome outcome = wait(process);
    ASSERT_EQ(outcome.code, 130) << outcome.out << outcome.error;
    EXPECT_EQ(Json::parse(content(path("parts") / "summary.json"))["status"], "interrupted");
    std::vector<std::string> resumed = long_run("parts");
    resumed.push_back("--resume");
    EXPECT_EQ(taut(resumed).code, 0);
    std::ifstream whole(path("whole") / "steps.jsonl"), parts(path("parts") / "steps.jsonl");
    for (std::string a, b; std::getline(whole, a);) {
      ASSERT_TRUE(std::getline(parts, b));
      Json x = Json::parse(a), y = Json::parse(b);
      x.erase("seconds");
      y.erase("seconds");
      EXPECT_EQ(x, y);
    }
  }
}

TEST_F(ProgramTest, HelpTeachesEveryOption) {
  const Outcome program = taut({"--help"});
  EXPECT_EQ(program.code, 0);
  for (const char* word : {"solve", "list", "schema", "--version", "Exit codes"})
    EXPECT_THAT(program.out, HasSubstr(word));
  const Outcome solve = taut({"solve", "--help"});
  EXPECT_EQ(solve.code, 0);
  for (const char* option : {"--out", "--json", "--set", "--threads", "--max-seconds", "--format", "--resume",
                             "--quiet", "PROBLEM", "Exit codes", "Examples"}) {
    EXPECT_THAT(solve.out, HasSubstr(option));
  }
}

TEST_F(ProgramTest, ListsExplainEachEntryInALine) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> lists{
      {"problems", {"hanging_cloth", "infeasible_pins", "twisted_sheet"}},
      {"solvers", {"augmented_lagrangian", "null_space", "ipopt", "nlopt"}},
      {"energies", {"membrane", "bending", "wind"}},
      {"constraints", {"pin", "strain_limit", "half_space", "sphere"}}};
  for (const auto& [what, names] : lists) {
    const Outcome outcome = taut({"list", what});
    EXPECT_EQ(outcome.code, 0);
    for (const std::string& name : names) EXPECT_THAT(outcome.out, HasSubstr(name + " "));
  }
}

TEST_F(ProgramTest, EveryListedProblemIsOneLineWithItsDescription) {
  std::istringstream lines(taut({"list", "problems"}).out);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_GT(line.size(), 30u) << line;
  EXPECT_GE(count, 10);
}

TEST_F(ProgramTest, TheSchemaIsJson) {
  const Outcome outcome = taut({"schema"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_TRUE(Json::parse(outcome.out).contains("properties"));
}

TEST_F(ProgramTest, TheVersionIsANumber) {
  EXPECT_THAT(taut({"--version"}).out, testing::MatchesRegex("taut [0-9.]+\n"));
}

}  // namespace
}  // namespace taut
