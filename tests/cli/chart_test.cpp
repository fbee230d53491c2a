// Runs `taut chart` as a shell would.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "study/child_process.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class ChartCommand : public FilesTest {
 protected:
  int chart(const std::vector<std::string>& arguments) const {
    std::vector<std::string> command{TAUT_PROGRAM, "chart"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return run_child(command, path("log"), {.seconds = 50}).code;
  }
  std::string log() const { return read_bytes(path("log")); }
  std::string out() const { return path("out").string(); }
  Json data() const { return Json::parse(read_bytes(path("out") / "chart.json")); }
  Json problem() const { return data()["problems"][0]; }
  Json points() const { return problem()["points"]; }
  bool has(const std::string& file) const { return std::filesystem::exists(path("out") / file); }

  const std::vector<std::string> cloth_{"hanging_cloth",
                                        "--set",
                                        "bodies.cloth.mesh.grid.cells=[8,8]",
                                        "--set",
                                        "time.steps=20",
                                        "--vary",
                                        "tolerance=1e-2,1e-4,1e-6",
                                        "--out",
                                        out()};
  std::vector<std::string> cloth(const std::vector<std::string>& more) const {
    std::vector<std::string> all = cloth_;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

TEST_F(ChartCommand, TheStripConvergesToItsClosedForm) {
  ASSERT_EQ(chart({"stretched_strip", "--vary", "mesh=0.25,0.5,1", "--solvers", "augmented_lagrangian", "--history",
                   "0", "--out", out()}),
            0)
      << log();
  const Json strip = problem();
  EXPECT_EQ(strip["references"][0]["kind"], "closed form");
  ASSERT_EQ(strip["points"].size(), 3u);
  for (const Json& point : strip["points"]) EXPECT_EQ(point["status"], "solved");
  // The kink at s* lies at another place of its cell in every mesh, so that single steps of the order scatter.
  const double coarse = strip["points"][0]["error"], fine = strip["points"][2]["error"];
  EXPECT_LT(coarse, 0.01);
  EXPECT_LT(fine, coarse / 16) << "second order from 1 x 10 to 4 x 40 cells";
  EXPECT_THAT(log(), AllOf(HasSubstr("reference: closed form"), HasSubstr("observed order of augmented_lagrangian")));
  EXPECT_TRUE(has("work_precision_stretched_strip.svg"));
  EXPECT_TRUE(has("error_stretched_strip.svg"));
}

TEST_F(ChartCommand, WithoutAClosedFormMeshesAreExtrapolatedByAnotherMethod) {
  ASSERT_EQ(chart({"stretched_strip", "--set", "constraints.limit.max=1.2", "--error", "position", "--vary",
                   "mesh=0.25,0.5", "--solvers", "augmented_lagrangian", "--history", "0", "--out", out()}),
            0)
      << log();
  const Json reference = problem()["references"][0];
  EXPECT_EQ(reference["kind"], "extrapolation");
  EXPECT_EQ(reference["solver"], "ipopt");
  EXPECT_GT(reference["order"].get<double>(), 1);
  EXPECT_LT(reference["estimated_error"].get<double>(), problem()["points"][0]["error"].get<double>());
}

TEST_F(ChartCommand, TighterTolerancesComeCloserToTheSolutionByAnotherMethod) {
  ASSERT_EQ(chart(cloth({"--solvers", "augmented_lagrangian,multiplier_loop"})), 0) << log();
  const Json cloth = problem(), reference = cloth["references"][0];
  EXPECT_EQ(reference["solver"], "ipopt");
  EXPECT_TRUE(reference["not_independent_of"].empty());
  EXPECT_LT(reference["estimated_error"].get<double>(), 1e-6);
  ASSERT_EQ(cloth["points"].size(), 6u);
  for (const std::size_t first : {0u, 3u}) {
    for (std::size_t k = first; k < first + 3; ++k) EXPECT_EQ(cloth["points"][k]["status"], "solved");
    EXPECT_LT(cloth["points"][first + 2]["error"].get<double>(), cloth["points"][first]["error"].get<double>());
    EXPECT_LT(cloth["points"][first + 2]["error"].get<double>(), 1e-5);
    EXPECT_GT(cloth["points"][first]["linear_solves"].get<int>(), 0);
    EXPECT_GT(cloth["points"][first]["factor_flops"].get<double>(), 0);
  }
  EXPECT_THAT(log(), HasSubstr("cheapest under"));
  for (const char* file : {"report.json", "chart.csv", "work_precision_hanging_cloth.svg",
                           "history_violation_hanging_cloth.svg", "history_penalty_seconds_hanging_cloth.svg"})
    EXPECT_TRUE(has(file)) << file;
  ASSERT_EQ(cloth["histories"].size(), 2u);
  for (const Json& history : cloth["histories"]) {
    ASSERT_GT(history["iterates"].size(), 2u);
    EXPECT_LT(history["iterates"].back()["stationarity"].get<double>(), 1e-4);
    EXPECT_GT(history["iterates"].back()["penalty"].get<double>(), 0);
  }
}

TEST_F(ChartCommand, TheCommandOfAPointGivesItAgain) {
  ASSERT_EQ(chart(cloth({"--solvers", "multiplier_loop", "--error", "violation", "--history", "0"})), 0) << log();
  const Json point = problem()["points"][1];
  std::vector<std::string> command{TAUT_PROGRAM};
  for (std::size_t k = 1; k < point["command"].size(); ++k) command.push_back(point["command"][k]);
  command.push_back("--json");
  command.push_back("--quiet");
  ASSERT_EQ(run_child(command, path("again"), {.seconds = 50}).code, 0);
  const Json summary = Json::parse(read_bytes(path("again")));
  EXPECT_EQ(summary["residuals"]["feasibility"], point["violation"]);
  EXPECT_EQ(summary["counts"]["linear_solves"], point["linear_solves"]);
}

TEST_F(ChartCommand, ARunThatIsNotSolvedIsKeptAndDrawnHollow) {
  ASSERT_EQ(chart(cloth({"--solvers", "multiplier_loop", "--set", "solver.max_newton=2", "--error", "violation",
                         "--history", "0"})),
            0)
      << log();
  const Json point = problem()["points"][2];
  EXPECT_EQ(point["status"], "iteration_limit");
  EXPECT_EQ(point["steps"]["done"], 20) << "runs go on after a step that is not solved";
  EXPECT_EQ(point["on_front"], false);
  EXPECT_THAT(read_bytes(path("out") / "work_precision_hanging_cloth.svg"), HasSubstr("fill=\"white\" stroke"));
  EXPECT_THAT(log(), HasSubstr("multiplier_loop at tolerance 1e-06: iteration_limit"));
}

TEST_F(ChartCommand, ALimitEndsARunAndNotTheChart) {
  std::vector<std::string> large =
      cloth({"--solvers", "multiplier_loop", "--memory-limit", "1", "--error", "violation"});
  large[4] = "time.steps=100";
  ASSERT_EQ(chart(large), 0) << log();
  for (const Json& point : points()) EXPECT_EQ(point["status"], "out_of_memory");
}

TEST_F(ChartCommand, AReferenceThatNobodySolvesExitsWithThree) {
  EXPECT_EQ(chart(cloth({"--solvers", "multiplier_loop", "--max-seconds", "1e-6", "--history", "0"})), 3) << log();
  EXPECT_EQ(problem()["references"][0]["kind"], "missing");
  for (const Json& point : points()) EXPECT_EQ(point["status"], "time_limit");
}

TEST_F(ChartCommand, SeveralProblemsHaveProfilesAndMeans) {
  ASSERT_EQ(chart({"stretched_strip", "coincident_stretches", "--set", "time.steps=2", "--solvers",
                   "augmented_lagrangian,multiplier_loop", "--error", "violation", "--out", out()}),
            0)
      << log();
  const Json both = data();
  ASSERT_EQ(both["problems"].size(), 2u);
  ASSERT_EQ(both["scores"].size(), 2u);
  EXPECT_EQ(both["scores"][0]["runs"], 2);
  EXPECT_EQ(both["scores"][0]["correct"], 2);
  EXPECT_TRUE(has("performance_profile.svg"));
  EXPECT_TRUE(has("data_profile.svg"));
  EXPECT_THAT(log(), HasSubstr("false  correct  solver"));
}

TEST_F(ChartCommand, ResumesAndRefusesWhatIsNotItsOwn) {
  const std::vector<std::string> quick =
      cloth({"--solvers", "multiplier_loop", "--error", "violation", "--history", "0"});
  ASSERT_EQ(chart(quick), 0) << log();
  for (const Json& point : points()) EXPECT_EQ(point["resumed"], false);
  std::vector<std::string> again = quick;
  again.push_back("--resume");
  ASSERT_EQ(chart(again), 0) << log();
  for (const Json& point : points()) EXPECT_EQ(point["resumed"], true);
  std::vector<std::string> elsewhere = quick;
  elsewhere[8] = path(".").string();
  EXPECT_EQ(chart(elsewhere), 2);
  EXPECT_THAT(log(), HasSubstr("holds no chart"));
}

TEST_F(ChartCommand, AnInterruptedChartKeepsFinishedRuns) {
  std::vector<std::string> slow = cloth({"--solvers", "multiplier_loop,augmented_lagrangian", "--error", "violation"});
  slow[4] = "time.steps=30";
  std::vector<std::string> command{TAUT_PROGRAM, "chart"};
  command.insert(command.end(), slow.begin(), slow.end());
  // Ctrl-C once the first run is finished.
  const std::string first = (path("out") / "runs/hanging_cloth/multiplier_loop_0.01/outcome.json").string();
  const std::string script = R"("$@" & chart=$!
    for k in $(seq 4000); do [ -e ")" +
                             first + R"(" ] && break; sleep 0.005; done
    kill -INT $chart
    wait $chart)";
  command.insert(command.begin(), {"bash", "-c", script, "bash"});
  EXPECT_EQ(run_child(command, path("log"), {.seconds = 50}).code, 130) << log();
  const Json interrupted = data();
  EXPECT_EQ(interrupted["interrupted"], true);
  EXPECT_EQ(interrupted["problems"][0]["points"][0]["status"], "solved");
  EXPECT_EQ(interrupted["problems"][0]["points"][5]["status"], "interrupted");
  EXPECT_THAT(log(), HasSubstr("--resume goes on"));
}

TEST_F(ChartCommand, ModelsOfARulerAreMeasuredAgainstTheFullShell) {
  ASSERT_EQ(chart({"modal_cantilever", "--set", "bodies.ruler.mesh.grid.cells=[8,1]", "--set", "time.steps=20",
                   "--solvers", "augmented_lagrangian", "--history", "0", "--error", "position", "--vary",
                   "model=one:bodies.ruler.modal.modes=1,ten:bodies.ruler.modal.modes=10,"
                   "shell:bodies.ruler.model=thick_shell;bodies.ruler.modal=null;"
                   R"(constraints.clamp={"type":"pin","body":"ruler","select":{"edges":["x0"]}})",
                   "--out", out()}),
            0)
      << log();
  EXPECT_THAT(problem()["references"][0]["text"].get<std::string>(), HasSubstr("the last model by null_space"));
  ASSERT_EQ(points().size(), 3u);
  for (const Json& point : points()) EXPECT_EQ(point["status"], "solved");
  EXPECT_EQ(points()[0]["value"], "one");
  const double one = points()[0]["error"], ten = points()[1]["error"], shell = points()[2]["error"];
  EXPECT_LT(ten, one) << "more modes are nearer to the shell";
  EXPECT_LT(shell, ten / 1000) << "the shell differs from a tighter solution of itself by its tolerance only";
}

TEST_F(ChartCommand, ModelsOfAQuiltAreMeasuredAtTheVerticesOfItsShell) {
  ASSERT_EQ(chart({"quilt", "--set", "bodies.quilt.mesh.grid.cells=[4,4]", "--set", "time.steps=3", "--solvers",
                   "augmented_lagrangian", "--reference", "augmented_lagrangian", "--history", "0", "--vary",
                   "model=shell:bodies.quilt.cover=null;bodies.quilt.model=thick_shell;constraints.limit=null,"
                   "wrinkled:bodies.quilt.cover.mesh.refine=1",
                   "--out", out()}),
            0)
      << log();
  const double shell = points()[0]["error"], wrinkled = points()[1]["error"];
  EXPECT_GT(shell, 1e-5) << "a cover makes a difference";
  EXPECT_LT(wrinkled, shell / 1000);
}

TEST_F(ChartCommand, WrongUsageExitsWithTwo) {
  EXPECT_EQ(chart({}), 2);
  EXPECT_EQ(chart({"hanging_cloth", "--solvers", "magic"}), 2);
  EXPECT_THAT(log(), HasSubstr("multiplier_loop"));
  EXPECT_EQ(chart({"hanging_cloth", "--vary", "tolerance=fast"}), 2);
  EXPECT_THAT(log(), HasSubstr("--vary tolerance: found fast, allowed: numbers above 0"));
  EXPECT_EQ(chart({"hanging_cloth", "--vary", "mesh=0.3"}), 2);
  EXPECT_EQ(chart({"pillow", "--vary", "mesh"}), 2);
  EXPECT_THAT(log(), HasSubstr("is a mesh from a file"));
  EXPECT_EQ(chart({"hanging_cloth", "--vary", "step=0.03"}), 2);
  EXPECT_EQ(chart({"stretched_strip", "--vary", "integrator"}), 2);
  EXPECT_EQ(chart({"hanging_cloth", "--vary", "penalty", "--solvers", "ipopt"}), 2);
  EXPECT_EQ(chart({"hanging_cloth", "--error", "probe"}), 2);
  EXPECT_THAT(log(), HasSubstr("/output/probes"));
  EXPECT_EQ(chart({"hanging_cloth", "--error", "guess"}), 2);
  EXPECT_EQ(chart({"hanging_cloth", "--resume"}), 2);
  EXPECT_EQ(chart({"hanging_cloth", "--history", "101"}), 2);
  EXPECT_EQ(chart({path(".").string()}), 2);
}

}  // namespace
}  // namespace taut
