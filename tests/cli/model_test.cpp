#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/runs_program.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class ModelTest : public RunsProgram {
 protected:
  /// A copy, as .sol files are written beside the model.
  std::string model(const std::string& name) {
    fs::copy_file(fs::path(TAUT_SOURCE_DIR) / "problems" / "nl" / (name + ".nl"), path(name + ".nl"));
    return path(name + ".nl").string();
  }
};

TEST_F(ModelTest, SolveWritesSummaryAndSolution) {
  const Outcome outcome = taut({"solve", model("infeasible_start"), "--out", folder("out"), "--json"});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_EQ(Json::parse(outcome.out)["status"], "solved");
  const Json solution = Json::parse(content(path("out") / "solution.json"));
  EXPECT_NEAR(solution["objective"].get<double>(), 2, 1e-5);
  EXPECT_EQ(solution["variables"].size(), 2u);
  EXPECT_EQ(solution["rows"].size(), 1u);
}

TEST_F(ModelTest, ReportShowsResidualsAndWorstRows) {
  const Outcome outcome = taut({"solve", model("infeasible_rows"), "--report", folder("report"), "--quiet"});
  EXPECT_EQ(outcome.code, 3) << outcome.error;
  const std::string page = content(path("report") / "index.html");
  EXPECT_THAT(page, HasSubstr("Rows and bounds furthest outside"));
  EXPECT_THAT(page, HasSubstr("Residuals, computed without the solver"));
}

TEST_F(ModelTest, SolveExitsWithThreeWhereThereIsNoPoint) {
  const Outcome outcome = taut({"solve", model("infeasible_rows")});
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("infeasible_rows: infeasible, no nearby point satisfies the constraints"));
  EXPECT_THAT(outcome.out, HasSubstr("rows and bounds furthest outside\n  5.00e-01  row _scon[1]"));
  for (const char* word : {"step", "vertex", "body", " N\n", "pins"}) EXPECT_THAT(outcome.out, Not(HasSubstr(word)));
}

TEST_F(ModelTest, AsAmplSolverItExitsWithZeroAndWritesTheSolution) {
  std::string stub = model("infeasible_rows");
  stub.resize(stub.size() - 3);
  EXPECT_EQ(taut({stub, "-AMPL"}).code, 0);
  EXPECT_THAT(content(stub + ".sol"), HasSubstr("objno 0 200"));
  const std::string good = model("range_rows");
  EXPECT_EQ(taut({good, "max_newton=50"}).code, 0);
  EXPECT_THAT(content(good.substr(0, good.size() - 3) + ".sol"), HasSubstr("objno 0 0"));
}

TEST_F(ModelTest, WrongInputIsOneLineAndExitsWithTwo) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"solve", "not_there.nl"},
                                                {"solve", model("range_rows"), "--resume", "--out", folder("out")},
                                                {"solve", path("range_rows.nl").string(), "--set", "time.steps=3"},
                                                {path("range_rows.nl").string(), "frobnicate"},
                                                {path("range_rows.nl").string(), "frobnicate=1"},
                                                {path("range_rows.nl").string(), "max_seconds=soon"}}) {
    const Outcome outcome = taut(words);
    EXPECT_EQ(outcome.code, 2) << outcome.out;
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  }
}

}  // namespace
}  // namespace taut
