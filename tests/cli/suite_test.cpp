#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/runs_program.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

class SuiteCommand : public RunsProgram {
 protected:
  /// Some of the models with known answers, and the answers.
  std::string suite() {
    fs::create_directories(path("suite"));
    for (const char* name : {"infeasible_rows", "fixed_variables", "range_rows"}) {
      const std::string file = std::string(name) + ".nl";
      fs::copy_file(fs::path(TAUT_SOURCE_DIR) / "problems" / "nl" / file, path("suite") / file);
    }
    std::ofstream(path("suite") / "reference.csv") << "name,n,f\nfixed_variables,3,8\nrange_rows,2,5.5\n";
    return folder("suite");
  }
};

TEST_F(SuiteCommand, CountsFalseSuccessesAndCorrectAnswers) {
  const Outcome outcome = taut({"compare", "--suite", suite(), "--solvers", "augmented_lagrangian,nlopt", "--set",
                                "solver.starts=1", "--out", folder("out"), "--report", folder("report"), "--quiet"});
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  const Json entries = Json::parse(content(path("out") / "compare.json"))["entries"];
  ASSERT_EQ(entries.size(), 2u);
  const Json &ours = entries[0], &slsqp = entries[1];
  EXPECT_EQ(ours["score"]["false_successes"], 0);
  EXPECT_EQ(ours["score"]["correct"], 2) << "the third has no solution";
  EXPECT_EQ(ours["runs"]["infeasible_rows"]["status"], "infeasible");
  EXPECT_GE(slsqp["score"]["false_successes"], 1);
  EXPECT_EQ(slsqp["runs"]["infeasible_rows"]["false_success"], true);
  EXPECT_EQ(slsqp["runs"]["fixed_variables"]["correct"], true);
  EXPECT_THAT(content(path("out") / "compare.csv"), HasSubstr("\"infeasible_rows\",\"nlopt\",finished,stalled,1,0,"));
  EXPECT_THAT(content(path("report") / "index.html"), HasSubstr("Performance profile"));
}

TEST_F(SuiteCommand, TheTableBeginsWithFalseSuccesses) {
  const Outcome outcome = taut({"compare", "--suite", suite(), "--solvers", "augmented_lagrangian"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("\nfalse"));
  EXPECT_THAT(outcome.out, HasSubstr("3 models, a best value is known of 2"));
}

TEST_F(SuiteCommand, AProcessOutOfMemoryIsRecordedAndEndsNothingElse) {
  const Outcome outcome = taut({"compare", "--suite", suite(), "--solvers", "augmented_lagrangian,nlopt",
                                "--memory-limit", "1", "--json", "--quiet"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  const Json result = Json::parse(outcome.out);
  for (const Json& entry : result["entries"]) {
    for (const Json& run : entry["runs"]) EXPECT_EQ(run["outcome"], "out_of_memory");
  }
}

TEST_F(SuiteCommand, WrongUsageIsOneLineAndExitsWithTwo) {
  const std::string good = suite();
  expect_refused({"compare", "--suite", folder("nowhere")}, "found no .nl files");
  expect_refused({"compare", "--suite", good, "hanging_cloth"}, "--suite takes no PROBLEM");
  expect_refused({"compare", "--suite", good, "--steps", "3"}, "--suite takes no PROBLEM");
  expect_refused({"compare", "--suite", good, "--set", "time.steps=3"}, "time");
  expect_refused({"compare", "--suite", good, "--solvers", "magic"}, "magic");
  expect_refused({"compare", "--suite", good, "--out", good}, "holds no comparison");
  expect_refused({"compare", "hanging_cloth"}, "--suite DIR");
  std::ofstream(path("suite") / "reference.csv") << "model,value\n";
  expect_refused({"compare", "--suite", good}, "allowed: name and f");
}

}  // namespace
}  // namespace taut
