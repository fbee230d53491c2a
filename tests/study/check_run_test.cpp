// A library of runs that were tampered with, each of which the check must catch and name.
#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "study/check.h"
#include "study/records_json.h"
#include "tests/study/tampered_run.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class CheckRun : public TamperedRunTest {
 protected:
  CheckReport check() { return check_run(folder(), {}); }
  /// The check finds this, and that the run is not within tolerance (exit code 3).
  void expect_found(const std::vector<std::string>& parts) {
    const CheckReport report = check();
    EXPECT_EQ(report.verdict(), CheckVerdict::outside);
    for (const std::string& part : parts) EXPECT_THAT(report.findings, Contains(HasSubstr(part)));
  }
  /// The check names this as what it cannot judge (exit code 2).
  void expect_unusable(const std::vector<std::string>& parts) {
    const CheckReport report = check();
    EXPECT_EQ(report.verdict(), CheckVerdict::unusable);
    for (const std::string& part : parts) EXPECT_THAT(report.unusable, Contains(HasSubstr(part)));
  }
  /// The last step as the check and as the run judged it: from the same numbers, so with the same bits.
  void expect_same_residuals() {
    const CheckReport report = check();
    EXPECT_EQ(report.verdict(), CheckVerdict::within)
        << testing::PrintToString(report.findings) << testing::PrintToString(report.unusable);
    ASSERT_TRUE(report.last_step);
    StepRecord last;
    change_steps([&](int, Json& line) { last = parse_step(line.dump()); });
    EXPECT_EQ(report.last_step->step, last.step);
    EXPECT_EQ(report.last_step->residuals.stationarity, last.residuals.stationarity);
    EXPECT_EQ(report.last_step->residuals.worst_node, last.residuals.worst_node);
    EXPECT_EQ(report.last_step->residuals.feasibility, last.residuals.feasibility);
    EXPECT_EQ(report.last_step->residuals.complementarity, last.residuals.complementarity);
    EXPECT_GT(last.residuals.stationarity, 0);
  }
};

TEST_F(CheckRun, AnUntouchedRunPassesWithEveryIntegrator) {
  for (const char* integrator : {"implicit_euler", "bdf2", "generalised_alpha"}) {
    SCOPED_TRACE(integrator);
    fs::remove_all(folder());
    solve(scene({{"time.integrator", integrator}}));
    expect_same_residuals();
    EXPECT_EQ(check().frames.size(), 4u);
  }
}

TEST_F(CheckRun, AnUntouchedStaticRunPasses) {
  solve(read_scene(TAUT_CATALOGUE "/stretched_strip.json", {{"bodies.strip.mesh.grid.cells", "[2,10]"}}));
  expect_same_residuals();
}

TEST_F(CheckRun, AnUntouchedRunPassesWithWindDampingAndMovingObstacles) {
  const Overrides rich{
      {"loads", R"({"wind": {"type": "wind", "body": "cloth", "velocity": [1, 0, 3]}})"},
      {"bodies.cloth.damping", R"({"mass": 0.5, "stiffness": 0.001})"},
      {"constraints.floor", R"({"type": "half_space", "body": "cloth", "point": [0, 0, -0.02], "normal": [0, 0, 1],
        "motion": {"velocity": [0, 0, 0.05]}})"}};
  for (const char* integrator : {"implicit_euler", "bdf2", "generalised_alpha"}) {
    SCOPED_TRACE(integrator);
    fs::remove_all(folder());
    Overrides overrides = rich;
    overrides.emplace_back("time.integrator", integrator);
    solve(scene(overrides));
    expect_same_residuals();
  }
}

TEST_F(CheckRun, ObjFramesAreJudgedToo) {
  solve(scene({{"output.format", "obj"}}));
  EXPECT_EQ(check().verdict(), CheckVerdict::within);
  EXPECT_EQ(check().frames.size(), 4u);
}

TEST_F(CheckRun, AResumedRunPasses) {
  EXPECT_EQ(solve(scene(), 3).status, Status::interrupted);
  expect_found({"not solved: interrupted, interrupted before step 4"});
  EXPECT_EQ(check().findings.size(), 1u);
  EXPECT_EQ(check().last_step->step, 3);
  solve(scene());
  expect_same_residuals();
}

TEST_F(CheckRun, OneVertexMovedIsFoundThoughNothingIsViolated) {
  solve(scene());
  change_frame(3, [](Frame& frame) { frame.positions[3 * 12 + 2] += 1e-7; });
  expect_found({"frames/tiny_00003.vtu: gravity of its positions is", "but steps.jsonl says"});
  change_frame(6, [](Frame& frame) { frame.positions[3 * 12] += 1e-7; });
  expect_found({"frames/tiny_00006.vtu: sigma_max of triangle ", "by its positions, but the file says"});
}

TEST_F(CheckRun, AChangedVelocityIsFound) {
  solve(scene());
  change_frame(3, [](Frame& frame) { frame.point_fields[0].values[3 * 12 + 2] += 1e-6; });
  expect_found({"frames/tiny_00003.vtu: kinetic"});
}

TEST_F(CheckRun, AStretchedEdgeIsFoundWithItsTriangle) {
  solve(scene());
  std::size_t corner = 0;  // the only triangle at vertex 0
  change_frame(3, [&](Frame& frame) {
    frame.positions[1] -= 0.1;
    for (std::size_t t = 0; t < frame.triangles.size(); ++t) {
      if (std::count(frame.triangles[t].begin(), frame.triangles[t].end(), 0) > 0) corner = t;
    }
  });
  expect_found(
      {"at triangle " + std::to_string(corner) + " of cloth, frame 3, allowed is 1e-06; violated in 1 of 4 frames",
       "frames/tiny_00003.vtu: violates limit by"});
}

TEST_F(CheckRun, APinThatSlippedIsFoundWithItsVertex) {
  solve(scene());
  change_frame(6, [](Frame& frame) { frame.positions[3 * 20] += 1e-3; });
  expect_found({"pins: 0.001 at vertex 20 of cloth, frame 6"});
}

TEST_F(CheckRun, TheFirstFrameMustBeHowTheProblemBegins) {
  solve(scene());
  change_frame(0, [](Frame& frame) { frame.positions[3 * 12 + 2] += 1e-7; });
  expect_found({"frames/tiny_00000.vtu: is not how the problem begins"});
}

TEST_F(CheckRun, TheLastFrameMustBeThatOfTheCheckpoint) {
  solve(scene());
  change_frame(8, [](Frame& frame) { frame.positions[3 * 12 + 2] += 1e-15; });
  expect_found({"frames/tiny_00008.vtu: its positions are not those of checkpoint.bin"});
}

TEST_F(CheckRun, ANanIsNamed) {
  solve(scene());
  change_frame(3, [](Frame& frame) { frame.positions[3 * 7 + 1] = nan; });
  expect_unusable({"frames/tiny_00003.vtu: vertex 7 of cloth is not finite"});
}

TEST_F(CheckRun, AMissingFileIsNamed) {
  solve(scene());
  fs::remove(frame(6));
  fs::remove(folder() / "pictures" / "tiny_00004.svg");
  expect_unusable({"frames/tiny_00006.vtu: is listed in summary.json, but not there", "pictures/tiny_00004.svg"});
}

TEST_F(CheckRun, AnotherNumberOfVerticesIsNamed) {
  solve(scene());
  change_frame(3, [](Frame& frame) {
    frame.positions.conservativeResize(frame.positions.size() + 3);
    frame.positions.tail<3>().setZero();
    frame.point_fields.clear();
  });
  expect_unusable({"frames/tiny_00003.vtu: has 26 vertices, the scene has 25"});
}

TEST_F(CheckRun, SwappedTrianglesAreNamed) {
  solve(scene());
  change_frame(3, [](Frame& frame) { std::swap(frame.triangles[5][1], frame.triangles[5][2]); });
  change_frame(6, [](Frame& frame) { std::swap(frame.triangles[5], frame.triangles[6]); });
  change_frame(8, [](Frame& frame) { frame.triangles[9] = {0, 12, 24}; });
  expect_unusable({"frames/tiny_00003.vtu: triangle 5 of cloth (vertices ", ") is turned over in face 5",
                   "frames/tiny_00006.vtu: its faces are in another order",
                   "frames/tiny_00008.vtu: triangle 9 of cloth", "face 9 has the vertices 0, 12, 24"});
}

TEST_F(CheckRun, MultipliersThatWereZeroedAreFound) {
  solve(scene());
  change_checkpoint([](Checkpoint& checkpoint) {
    std::vector<double>& multipliers = checkpoint.arrays.at("multipliers 0");
    multipliers.assign(multipliers.size(), 0.0);
  });
  const CheckReport report = check();
  EXPECT_EQ(report.verdict(), CheckVerdict::outside);
  EXPECT_THAT(report.findings, Contains(AllOf(HasSubstr("stationarity of step 8 is "), HasSubstr("steps.jsonl says"))));
  EXPECT_THAT(report.findings,
              Contains(AllOf(HasSubstr("stationarity of step 8 is "), HasSubstr("more than 1e-06 (vertex "))));
}

TEST_F(CheckRun, AStoredPositionThatWasMovedIsFound) {
  solve(scene());
  change_checkpoint([](Checkpoint& checkpoint) { checkpoint.arrays.at("positions")[3 * 12] += 1e-5; });
  expect_found({"stationarity of step 8", "frames/tiny_00008.vtu: its positions are not those of checkpoint.bin"});
}

class CheckFailedRun : public CheckRun {
 protected:
  CheckFailedRun() { solve(scene({{"solver.central_path", "false"}, {"solver.max_newton", "1"}})); }
};

TEST_F(CheckFailedRun, IsCalledWhatItIs) {
  const CheckReport report = check();
  EXPECT_EQ(report.verdict(), CheckVerdict::outside);
  EXPECT_THAT(report.findings, Contains(HasSubstr("the run is not solved: iteration_limit")));
  EXPECT_THAT(report.findings, testing::Not(Contains(HasSubstr("steps.jsonl says")))) << "its claims are true";
}

TEST_F(CheckFailedRun, ASummaryEditedToSolvedIsFound) {
  change_summary([](Json& summary) { summary["status"] = "solved"; });
  expect_found({"summary.json: status is \"solved\", but steps.jsonl and problem.json give \"iteration_limit\""});
}

TEST_F(CheckFailedRun, StepsEditedToSolvedAreFound) {
  change_steps([](int, Json& step) { step["status"] = "solved"; });
  expect_found({"is called solved, but its own residuals are not within tolerance"});
}

TEST_F(CheckFailedRun, EveryClaimEditedIsFoundByComputingThemAnew) {
  const auto embellish = [](Json& json) {
    json["status"] = "solved";
    json["message"] = "";
    for (const char* name : {"stationarity", "stationarity_unscaled", "feasibility", "complementarity"})
      json["residuals"][name] = 1e-9;
  };
  change_steps([&](int, Json& step) { embellish(step); });
  change_summary([&](Json& summary) { embellish(summary), summary["steps"]["solved"] = 1; });
  expect_found({"stationarity of step 1 is ", "but steps.jsonl says 1e-09", "more than 1e-06"});
}

TEST_F(CheckRun, ASummaryThatDiffersFromTheStepsIsFound) {
  solve(scene());
  change_summary([](Json& summary) {
    summary["residuals"]["stationarity"] = 1e-12;
    summary["violations"]["limit"]["max"] = 0.5;
    summary["steps"]["solved"] = 7;
    summary["input_hash"] = "0123456789abcdef";
  });
  expect_found({"summary.json: residuals/stationarity is 1e-12, but", "summary.json: violations/limit/max is 0.5",
                "summary.json: steps/solved is 7", "summary.json: input_hash is \"0123456789abcdef\""});
}

TEST_F(CheckRun, AnEnergyOrObjectiveThatWasEditedIsFound) {
  solve(scene());
  change_steps([](int step, Json& line) {
    if (step == 6) line["energies"]["kinetic"] = 0.0;
    if (step == 8) line["objective"] = 0.0;
  });
  expect_found({"frames/tiny_00006.vtu: kinetic", "objective of step 8 is ", "summary.json: objective is"});
}

TEST_F(CheckRun, ADepthInASphereThatWasEditedIsFound) {
  solve(scene({{"constraints.ball", R"({"type": "sphere", "body": "cloth", "center": [0.5, 0.5, -0.25],
    "radius": 0.245})"}}));
  EXPECT_EQ(check().verdict(), CheckVerdict::within) << testing::PrintToString(check().findings);
  change_steps([](int, Json& line) { line["violations"]["ball"]["face_penetration"] = 1.0; });
  expect_found({"frames/tiny_00006.vtu: edges and faces are ", "m inside ball, but steps.jsonl says"});
}

TEST_F(CheckRun, NumbersThatAreNotFiniteInTheCheckpointAreNamed) {
  solve(scene());
  change_checkpoint([](Checkpoint& checkpoint) { checkpoint.arrays.at("positions")[3 * 12] = nan; });
  expect_unusable({"checkpoint.bin: vertex 12 of cloth is not finite"});
  change_checkpoint([](Checkpoint& checkpoint) {
    checkpoint.arrays.at("positions")[3 * 12] = 0;
    checkpoint.arrays.at("multipliers 0")[3 * 4 + 1] = nan;
  });
  expect_unusable({"checkpoint.bin: the multiplier of limit at triangle 4 of cloth is not finite"});
}

TEST_F(CheckRun, WrongSizesAreNamed) {
  solve(scene());
  change_checkpoint([](Checkpoint& checkpoint) { checkpoint.arrays.at("multipliers 0").pop_back(); });
  expect_unusable({"checkpoint.bin: does not fit the problem: residuals: multipliers of limit have 95 entries"});
  change_checkpoint([](Checkpoint& checkpoint) { checkpoint.arrays.at("before previous_positions").pop_back(); });
  expect_unusable({"state.previous_positions has 74 entries, expected 75"});
}

TEST_F(CheckRun, ACheckpointOfAnEarlierVersionIsNamed) {
  solve(scene());
  change_checkpoint([](Checkpoint& checkpoint) {
    std::erase_if(checkpoint.arrays, [](const auto& array) { return array.first.starts_with("before "); });
  });
  expect_unusable({"lacks the state before the last step"});
}

TEST_F(CheckRun, WhatIsNoRunIsRefusedInALine) {
  const auto refusal = [this] {
    try {
      check();
    } catch (const std::runtime_error& error) {  // RunRefused, FileError, InputError
      return std::string(error.what());
    }
    return std::string("nothing was thrown");
  };
  EXPECT_THAT(refusal(), HasSubstr("there is no such directory"));
  fs::create_directory(folder());
  EXPECT_THAT(refusal(), HasSubstr("holds no run"));
  solve(scene());

  const std::string problem = read_bytes(folder() / "problem.json"), steps = read_bytes(folder() / "steps.jsonl"),
                    summary = read_bytes(folder() / "summary.json");
  Json other = Json::parse(problem);
  other["constraints"]["limit"]["max"] = 1.3;
  write_atomically(folder() / "problem.json", other.dump());
  EXPECT_THAT(refusal(), HasSubstr("belongs to another problem"));
  write_atomically(folder() / "problem.json", problem);

  write_atomically(folder() / "steps.jsonl", steps.substr(0, steps.size() / 2));
  EXPECT_THAT(refusal(), HasSubstr("steps.jsonl: line 5: not a step of Taut"));
  write_atomically(folder() / "steps.jsonl", steps.substr(0, steps.find('\n') + 1));
  EXPECT_THAT(refusal(), HasSubstr("steps.jsonl: holds 1 steps where the checkpoint was written after 8"));
  write_atomically(folder() / "steps.jsonl", steps.substr(steps.find('\n') + 1));
  EXPECT_THAT(refusal(), HasSubstr("steps.jsonl: line 1: holds step 2, a step is missing"));
  write_atomically(folder() / "steps.jsonl", steps);

  fs::remove(folder() / "summary.json");
  EXPECT_THAT(refusal(), HasSubstr("summary.json: is missing"));
  write_atomically(folder() / "summary.json", "{}");
  EXPECT_THAT(refusal(), HasSubstr("not a summary of Taut"));
  write_atomically(folder() / "summary.json", summary);

  flip(folder() / "checkpoint.bin", 200, 1);
  EXPECT_THAT(refusal(), HasSubstr("damaged checkpoint"));
  flip(folder() / "checkpoint.bin", 200, 1);
  EXPECT_EQ(check().verdict(), CheckVerdict::within);
}

TEST_F(CheckRun, AnotherToleranceOfViolationsIsTaken) {
  solve(scene());
  change_frame(3, [](Frame& frame) { frame.positions[1] -= 0.1; });
  EXPECT_FALSE(check().worst.at(0).within());
  const CheckReport loose = check_run(folder(), 1.0);
  EXPECT_TRUE(loose.worst.at(0).within());
  EXPECT_EQ(loose.verdict(), CheckVerdict::outside) << "the frame still is not that of the run";
}

/// Says that a step is solved, with a NaN in it.
class BrokenSolver final : public Solver {
 public:
  std::string name() const override { return "broken"; }
  Result solve(const Problem& problem, const WarmStart&, const Budget&) override {
    Result result;
    result.status = Status::solved;
    result.x = problem.initial_guess;
    result.x[0] = nan;
    for (const Constraint* constraint : problem.constraints)
      result.multipliers.emplace_back(Vector::Zero(constraint->stencils().count() * constraint->rows()));
    return result;
  }
};

TEST_F(CheckRun, ARunThatEndedInNansIsCalledSo) {
  BrokenSolver solver;
  RunOptions options;
  options.folder = folder();
  options.solver = &solver;
  run(scene(), options);
  expect_found({"the run is not solved: not_finite"});
}

}  // namespace
}  // namespace taut
