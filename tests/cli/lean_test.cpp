// Runs `taut lean` and `taut check --lean` as a shell would.
#include <csignal>
#include <nlohmann/json.hpp>

#include "tests/cli/runs_program.h"

namespace taut {
namespace {

using Json = nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class LeanCommand : public RunsProgram {
 protected:
  Json data(const std::string& name) const { return Json::parse(content(path(name) / "lean.json")); }
  static Json rung(const Json& data, const std::string& which) {
    for (const Json& one : data["rungs"])
      if (one["name"] == data[which]) return one;
    return {};
  }
  const std::vector<std::string> strip_{"lean", "stretched_strip", "--quantity", "probe:lengthening", "--tolerance",
                                        "1%"};
  std::vector<std::string> strip(const std::vector<std::string>& more) const {
    std::vector<std::string> all = strip_;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

TEST_F(LeanCommand, FindsAModelThatRunsAndIsAsExactAsItSays) {
  ASSERT_EQ(taut({"solve", "stretched_strip", "--out", folder("full"), "--quiet"}).code, 0);
  const Outcome outcome = taut(strip({"--out", folder("out"), "--known", folder("full")}));
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("answers probe:lengthening to"), HasSubstr("Verified against"),
                                 HasSubstr("without strain limit limit"), HasSubstr("it changes the answer")));
  const Json study = data("out"), lean = rung(study, "lean");
  EXPECT_EQ(study["end"], "verified");
  EXPECT_TRUE(study["full"].is_null()) << "the full scene was not run";
  EXPECT_LE(lean["true_error"].get<double>(), study["allowed_error"].get<double>());
  EXPECT_LE(lean["verified_error"].get<double>(), study["allowed_error"].get<double>());
  EXPECT_TRUE(std::filesystem::exists(path("out") / "pareto.svg"));

  const Outcome again = taut({"solve", (path("out") / "stretched_strip.lean.json").string(), "--json"});
  ASSERT_EQ(again.code, 0) << again.error;
  EXPECT_EQ(Json::parse(again.out)["probes"]["lengthening"]["value"], lean["answer"]);
}

TEST_F(LeanCommand, OneSceneHasOneAnswer) {
  ASSERT_EQ(taut(strip({"--out", folder("a"), "--quiet"})).code, 0);
  ASSERT_EQ(taut(strip({"--out", folder("b"), "--quiet"})).code, 0);
  EXPECT_EQ(content(path("a") / "stretched_strip.lean.json"), content(path("b") / "stretched_strip.lean.json"));
}

TEST_F(LeanCommand, GivesTheBestFoundWhenTheTimeIsOver) {
  const Outcome outcome = taut({"lean", "hanging_cloth", "--quantity", "shape", "--tolerance", "abs:1e-9",
                                "--max-seconds", "1", "--out", folder("out")});
  EXPECT_EQ(outcome.code, 3) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("NOT VERIFIED: the time was over"));
  EXPECT_TRUE(std::filesystem::exists(path("out") / "hanging_cloth.lean.json"));
}

TEST_F(LeanCommand, EndsWithWhatIsFinishedWhenInterrupted) {
  const pid_t process =
      start({"lean", "hanging_cloth", "--quantity", "shape", "--tolerance", "abs:1e-9", "--out", folder("out")});
  while (!std::filesystem::exists(path("out") / "runs" / "hanging_cloth_02")) ::usleep(1000);
  ::kill(process, SIGINT);
  const Outcome outcome = wait(process);
  EXPECT_EQ(outcome.code, 130) << outcome.error;
  EXPECT_EQ(data("out")["end"], "interrupted");
}

TEST_F(LeanCommand, RefusesWhatItCannotAnswer) {
  expect_refused({"lean", "stretched_strip", "--quantity", "probe:tip"}, "allowed: lengthening");
  expect_refused({"lean", "stretched_strip", "--quantity", "length"}, "allowed: probe:NAME, displacement");
  expect_refused({"lean", "stretched_strip", "--tolerance", "1J"}, "--tolerance 1J: allowed for displacement: 5%");
  expect_refused({"lean", "hanging_cloth", "--quantity", "frequency:1"}, "found a dynamic problem, allowed: static");
  expect_refused({"lean", "no_such_problem"}, "no_such_problem");
  std::filesystem::create_directories(path("other") / "work");
  expect_refused(strip({"--out", folder("other")}), "holds no search of taut lean");
}

TEST_F(LeanCommand, ACheckNamesWhatCouldGo) {
  const Outcome outcome =
      taut({"check", "trampoline", "--lean", "--quantity", "displacement", "--tolerance", "1%", "--set",
            "bodies.mat.mesh.grid.cells=[8,8]", "--set", "time.steps=20", "--out", folder("out")});
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  const Json study = data("out");
  std::map<std::string, bool> could_go;
  for (const Json& omission : study["omissions"]) could_go[omission["what"]] = omission["left_out"];
  EXPECT_TRUE(could_go.at("without bending of mat"));
  EXPECT_FALSE(could_go.at("without load weight"));
  EXPECT_FALSE(could_go.at("without gravity"));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("could go, each alone"), HasSubstr("as written:")));
}

}  // namespace
}  // namespace taut
