#include <nlohmann/json.hpp>

#include "tests/cli/runs_program.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

class CheckProgram : public RunsProgram {
 protected:
  CheckProgram() {
    EXPECT_EQ(taut({"solve", "hanging_cloth", "--set", cells_, "--set", "time.steps=5", "--threads", "1", "--format",
                    "obj", "--quiet", "--out", folder("run")})
                  .code,
              0);
  }
  std::vector<std::string> frames(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"check", "hanging_cloth", "--set",
                                       cells_,  "--frames",      folder("run/frames/*.obj")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::string frame(int step) const { return folder("run/frames/hanging_cloth_0000" + std::to_string(step) + ".obj"); }
  /// Moves the first vertex, which is free, far away.
  void spoil(int step) {
    std::string text = content(frame(step));
    text.replace(0, text.find('\n'), "v 5 0 0");
    std::ofstream(frame(step)) << text;
  }
  const std::string cells_ = "bodies.cloth.mesh.grid.cells=[6,6]";
};

TEST_F(CheckProgram, ARunThatIsAsItWasExitsWithZero) {
  const Outcome outcome = taut({"check", folder("run")});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("within tolerance"));
  EXPECT_THAT(outcome.out, HasSubstr("residuals of step 5, computed anew"));
  EXPECT_EQ(outcome.error, "");
  const Outcome as_frames = taut(frames());
  EXPECT_EQ(as_frames.code, 0) << as_frames.out;
  EXPECT_THAT(as_frames.out, HasSubstr("inverted faces"));
}

TEST_F(CheckProgram, WhatIsWrongExitsWithThreeAndIsNamed) {
  spoil(3);
  const Outcome run = taut({"check", folder("run")});
  EXPECT_EQ(run.code, 3);
  EXPECT_THAT(run.out, HasSubstr("frames/hanging_cloth_00003.obj: violates limit"));
  const Outcome outcome = taut(frames());
  EXPECT_EQ(outcome.code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("not within tolerance"));
  EXPECT_THAT(outcome.out, HasSubstr("of cloth, frame 3"));
  EXPECT_EQ(taut(frames({"--tolerance", "100", "--max-fold", "180"})).code, 0) << "as wide as that, nothing is wrong";
}

TEST_F(CheckProgram, WhatCannotBeJudgedExitsWithTwoAndIsNamed) {
  fs::remove(frame(2));
  const Outcome run = taut({"check", folder("run")});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.error, HasSubstr("hanging_cloth_00002.obj: is listed in summary.json, but not there"));
  EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1);
  const Outcome outcome = taut(frames());
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.error, HasSubstr("frame 2 is missing between"));
  EXPECT_THAT(outcome.out, HasSubstr("violations over 5 frames")) << "the others are judged all the same";
}

TEST_F(CheckProgram, TheProblemOfARunJudgesOtherFrames) {
  EXPECT_EQ(taut({"check", folder("run"), "--frames", folder("run/frames/*.obj")}).code, 0);
}

TEST_F(CheckProgram, SeveralFilesMayBeNamed) {
  EXPECT_EQ(taut(frames({frame(1), frame(2)})).code, 0);
  EXPECT_EQ(
      taut({"check", "--set", cells_, "--frames", frame(1), "--frames", frame(2), "--json", "hanging_cloth"}).code, 0);
}

TEST_F(CheckProgram, JsonAndCsvHoldTheVerdicts) {
  spoil(3);
  const Outcome outcome = taut(frames({"--json", "--csv", folder("a.csv"), "--out", folder("out")}));
  EXPECT_EQ(outcome.code, 3);
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["verdict"], "not within tolerance");
  EXPECT_EQ(json["frames"].size(), 6u);
  EXPECT_EQ(json["frames"][3]["within"], false);
  EXPECT_EQ(json["frames"][2]["within"], true);
  EXPECT_GT(json["frames"][3]["constraints"]["limit"]["max"], 1);
  EXPECT_THAT(json["frames"][3]["constraints"]["limit"]["where"].get<std::string>(), HasSubstr(" of cloth"));
  EXPECT_EQ(content(path("out/check.json")), outcome.out);
  const std::string csv = content(path("a.csv"));
  EXPECT_EQ(content(path("out/check.csv")), csv);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 6 * 4);
  EXPECT_THAT(csv, testing::StartsWith("file,number,time,constraint,max,"));
  EXPECT_THAT(csv, HasSubstr("hanging_cloth_00003.obj\",3,0.03,\"limit\","));
}

TEST_F(CheckProgram, WrongUsageAndInputExitWithTwoAndOneLine) {
  expect_refused({"check"}, "SUBJECT is required");
  expect_refused({"check", "hanging_cloth"}, "is not the directory of a run; to judge other files, add --frames");
  expect_refused({"check", folder("none")}, "is not the directory of a run");
  fs::create_directory(path("mine"));
  std::ofstream(path("mine") / "thesis.txt") << "irreplaceable";
  expect_refused({"check", folder("mine")}, "holds no run");
  expect_refused({"check", folder("run"), "--dt", "0.1"}, "are for frames of another program");
  expect_refused(frames({"--tolerance", "0"}), "expected a number above 0, got 0");
  expect_refused(frames({"--dt", "fast"}), "expected a number above 0, got fast");
  expect_refused(frames({"--first-time", "inf"}), "expected a number, got inf");
  expect_refused({"check", "no_such_problem", "--frames", "x"}, "no such file, and no problem of the catalogue");
  expect_refused({"check", folder("run"), "--out", folder("mine") + "/thesis.txt/x"}, "cannot be created");
  expect_refused({"check", folder("run"), "--csv", folder("none") + "/a.csv"}, "none/a.csv");
  flip(path("run/checkpoint.bin"), 300, 1);
  expect_refused({"check", folder("run")}, "damaged checkpoint");
}

TEST_F(CheckProgram, HelpTeachesEveryOption) {
  const Outcome help = taut({"check", "--help"});
  EXPECT_EQ(help.code, 0);
  for (const char* option : {"--frames", "--tolerance", "--dt", "--first-time", "--max-fold", "--set", "--csv", "--out",
                             "--json", "--quiet", "Exit codes", "Examples"}) {
    EXPECT_THAT(help.out, HasSubstr(option));
  }
}

}  // namespace
}  // namespace taut
