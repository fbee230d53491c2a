#include "study/probes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "problems/read_scene.h"
#include "study/check.h"
#include "study/frame_files.h"
#include "study/records_json.h"
#include "study/run.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// A static quarter of a simply supported square plate under a uniform load of two load steps, with a/t = 10.
class Probes : public FilesTest {
 protected:
  Scene plate(const Overrides& overrides = {}) const {
    std::ofstream(path("plate.json")) << R"({
      "format": 1, "time": {"integrator": "static", "steps": 2},
      "bodies": {"s": {"model": "thick_shell", "mesh": {"grid": {"size": [0.5, 0.5], "cells": [8, 8]}},
        "thickness": 0.1, "density": 1, "material": {"law": "stvk", "young_modulus": 1.092e4, "poisson_ratio": 0.3}}},
      "constraints": {
        "x0": {"type": "pin", "body": "s", "select": {"edges": ["x0"]}, "axes": "yz"},
        "y0": {"type": "pin", "body": "s", "select": {"edges": ["y0"]}, "axes": "xz"},
        "x1": {"type": "pin", "body": "s", "select": {"edges": ["x1"]}, "axes": "x"},
        "y1": {"type": "pin", "body": "s", "select": {"edges": ["y1"]}, "axes": "y"}},
      "loads": {"q": {"type": "surface_load", "body": "s", "force_per_area": [0, 0, 0.1]}},
      "output": {"probes": {
        "w": {"quantity": "displacement_z", "select": {"corners": ["x1y1"]}, "factor": 10,
              "expected": {"value": 0.004272842263, "relative": 0.03, "source": "Mindlin, k = 5/6"}},
        "top": {"quantity": "z", "select": {"corners": ["x1y1"]}, "surface": "top"},
        "support": {"quantity": "force_z", "select": {"edges": ["x0", "y0"]}},
        "work": {"quantity": "energy"}}}})";
    return read_scene(path("plate.json"), overrides);
  }
  RunSummary solve(const Scene& scene) const {
    RunOptions options;
    options.folder = path("out");
    options.threads = 1;
    return run(scene, options);
  }
  double value(const RunSummary& summary, const std::string& name) const {
    for (const ProbeValue& probe : summary.probes)
      if (probe.name == name) return probe.value;
    return std::nan("");
  }
};

TEST_F(Probes, MeasureAPlateThatIsSolvedStatically) {
  const RunSummary summary = solve(plate());
  EXPECT_EQ(summary.status, Status::solved) << summary.message;
  EXPECT_NEAR(value(summary, "w"), 0.004272842263, 0.03 * 0.004272842263);
  EXPECT_LT(value(summary, "w"), 0.0042728);  // 8 cells are too stiff
  EXPECT_NEAR(value(summary, "top"), 0.05 + value(summary, "w") / 10, 1e-5);
  EXPECT_NEAR(value(summary, "support"), -0.1 * 0.25, 1e-6);  // what the supports carry
  // The work of a load that grows from zero: half of load times displacement, less than that of the largest.
  EXPECT_GT(value(summary, "work"), 0);
  EXPECT_LT(value(summary, "work"), 0.5 * 0.1 * 0.25 * value(summary, "w") / 10);
}

TEST_F(Probes, AreWrittenForEveryStep) {
  const RunSummary summary = solve(plate());
  EXPECT_THAT(summary.files, Contains("probes.csv"));
  std::ifstream csv(path("out/probes.csv"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(csv, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], "step,time,support,top,w,work");
  EXPECT_THAT(lines[1], testing::StartsWith("1,0.5,-0.0125"));
  EXPECT_THAT(lines[2], testing::StartsWith("2,1,-0.025"));
  std::ifstream file(path("out/summary.json"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const RunSummary stored = parse_summary(text);
  EXPECT_EQ(summary_text(stored), text);
  EXPECT_EQ(value(stored, "w"), value(summary, "w"));
  EXPECT_TRUE(stored.probes.at(2).within());
}

TEST_F(Probes, AreComparedWithWhatIsExpected) {
  solve(plate());
  const CheckReport good = check_run(path("out"), {});
  EXPECT_EQ(good.verdict(), CheckVerdict::within) << testing::PrintToString(good.findings);
  EXPECT_EQ(good.probes.size(), 4u);
  const RunSummary summary = solve(plate({{"output.probes.w.expected.relative", "1e-4"}}));
  EXPECT_FALSE(summary.probes.at(2).within());
  const CheckReport off = check_run(path("out"), {});
  EXPECT_EQ(off.verdict(), CheckVerdict::outside);
  EXPECT_THAT(off.findings, Contains(HasSubstr("probe w is 0.004")));
}

TEST_F(Probes, WithAnEditedValueAreFound) {
  solve(plate());
  std::ifstream file(path("out/steps.jsonl"));
  std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t at = text.rfind("\"work\":");
  ASSERT_NE(at, text.npos);
  text.replace(at, 8, "\"work\":9");
  std::ofstream(path("out/steps.jsonl")) << text;
  EXPECT_THAT(check_run(path("out"), {}).findings, Contains(HasSubstr("probe work of step 2 is")));
}

TEST_F(Probes, GoOnWithAResumedRun) {
  const auto csv = [&] {
    std::ifstream file(path("out/probes.csv"));
    return std::string{std::istreambuf_iterator<char>(file), {}};
  };
  solve(plate());
  const std::string whole = csv();
  std::atomic<bool> stop = false;
  RunOptions options;
  options.folder = path("out");
  options.threads = 1;
  options.stop = &stop;
  options.on_step = [&](const StepRecord&) { stop = true; };
  EXPECT_EQ(run(plate(), options).status, Status::interrupted);
  EXPECT_NE(csv(), whole);
  options.stop = nullptr;
  options.on_step = nullptr;
  options.resume = true;
  EXPECT_EQ(run(plate(), options).status, Status::solved);
  EXPECT_EQ(csv(), whole);
}

TEST_F(Probes, OfAShellInFreeFallFollowGravity) {
  for (const char* mass : {"lumped", "consistent"}) {
    std::ofstream(path("fall.json")) << R"({
      "format": 1, "time": {"integrator": "bdf2", "step": 0.1, "steps": 5}, "gravity": [0, 0, -10],
      "bodies": {"s": {"model": "thick_shell", "mesh": {"grid": {"size": [1, 1], "cells": [2, 2]}}, "mass": ")"
                                     << mass << R"(",
        "layers": [
          {"thickness": 0.1, "density": 5, "material": {"law": "neo_hookean", "young_modulus": 1e4, "poisson_ratio": 0.3}},
          {"thickness": 0.2, "density": 1, "material": {"law": "stvk", "young_modulus": 1e3, "poisson_ratio": 0}}]}},
      "output": {"probes": {"fallen": {"quantity": "displacement", "select": {"all": true}},
                            "strained": {"quantity": "energy"}}}})";
    const RunSummary summary = solve(read_scene(path("fall.json")));
    EXPECT_EQ(summary.status, Status::solved) << summary.message;
    EXPECT_NEAR(value(summary, "fallen"), 0.5 * 10 * 0.25, 1e-6) << mass;
    EXPECT_NEAR(value(summary, "strained"), 0, 1e-9) << mass;
  }
}

/// A strip rolled up to a half circle in one load step, which is more than Newton's method can do in 60 systems.
class LoadParts : public Probes {
 protected:
  Scene strip(const std::string& halvings) const {
    std::ofstream(path("strip.json")) << R"({
      "format": 1, "time": {"integrator": "static", "steps": 1},
      "bodies": {"s": {"model": "thick_shell", "mesh": {"grid": {"size": [10, 1], "cells": [20, 1]}},
        "thickness": 0.1, "density": 1, "material": {"law": "stvk", "young_modulus": 12000, "poisson_ratio": 0}}},
      "constraints": {
        "end": {"type": "pin", "body": "s", "select": {"edges": ["x0"]}},
        "plane": {"type": "pin", "body": "s", "select": {"all": true}, "axes": "y"}},
      "loads": {"m": {"type": "end_moment", "body": "s", "select": {"edges": ["x1"]},
        "moment_per_length": [0, -0.31415926535, 0]}},
      "solver": {"max_newton": 60, "tolerance": {"stationarity": 1e-7}},
      "output": {"probes": {"x": {"quantity": "x", "select": {"edges": ["x1"]}}, "z": {"quantity": "z", "select": {"edges": ["x1"]}}}}})";
    return read_scene(path("strip.json"), {{"time.halvings", halvings}});
  }
};

TEST_F(LoadParts, ReachALoadThatOneStepDoesNot) {
  EXPECT_NE(solve(strip("0")).status, Status::solved);
  const RunSummary summary = solve(strip("6"));
  ASSERT_EQ(summary.status, Status::solved) << summary.message;
  EXPECT_EQ(summary.steps_done, 1);
  EXPECT_NEAR(value(summary, "x"), 0, 0.2);  // a half circle of length 10
  EXPECT_NEAR(value(summary, "z"), 20 / M_PI, 0.2);
  const CheckReport report = check_run(path("out"), {});
  EXPECT_EQ(report.verdict(), CheckVerdict::within) << testing::PrintToString(report.findings);
}

TEST_F(LoadParts, StopWhereTheSmallestPartIsNotSolved) {
  Scene scene = strip("2");
  scene.solver.max_newton = 1;
  const RunSummary summary = solve(scene);
  EXPECT_EQ(summary.status, Status::limit_point);
  EXPECT_THAT(summary.message, HasSubstr("the load stops at 0 of the whole, a larger one is not solved"));
}

/// A snap takes more Newton systems than a step towards the limit, so that few of them stop the load there.
TEST_F(LoadParts, StopAtALimitPointWhereNoSnapIsAllowed) {
  const auto arch = std::filesystem::path(TAUT_CATALOGUE) / "validation" / "snap_through.json";
  const RunSummary stopped = solve(read_scene(arch, {{"solver.max_newton", "8"}}));
  EXPECT_EQ(stopped.status, Status::limit_point);
  const std::string before = "the load stops at ";
  const std::size_t at = stopped.message.find(before);
  ASSERT_NE(at, stopped.message.npos) << stopped.message;
  EXPECT_NEAR(std::stod(stopped.message.substr(at + before.size())), 1 / 1.3, 0.015 / 1.3);
  EXPECT_GT(value(stopped, "z"), 0);  // still on this side
  const RunSummary snapped = solve(read_scene(arch));
  EXPECT_EQ(snapped.status, Status::solved);
  EXPECT_LT(value(snapped, "z"), -0.1);
}

class ShellProbes : public Probes {
 protected:
  /// A cantilever of 10 m x 1 m x 0.5 m, EI = 1, under a small force at its end.
  Scene cantilever(const Overrides& overrides = {}) const {
    std::ofstream(path("strip.json")) << R"({
      "format": 1, "time": {"integrator": "static", "steps": 1, "frequencies": 2},
      "bodies": {"s": {"model": "thick_shell", "mesh": {"grid": {"size": [10, 1], "cells": [20, 1]}}, "mass": "consistent",
        "thickness": 0.5, "density": 1, "material": {"law": "stvk", "young_modulus": 96, "poisson_ratio": 0}}},
      "constraints": {
        "end": {"type": "pin", "body": "s", "select": {"edges": ["x0"]}},
        "plane": {"type": "pin", "body": "s", "select": {"all": true}, "axes": "y"}},
      "loads": {"f": {"type": "edge_load", "body": "s", "select": {"edges": ["x1"]}, "force_per_length": [0, 0, 1e-5]}},
      "solver": {"tolerance": {"stationarity": 1e-7}},
      "output": {"stresses": true, "probes": {
        "m": {"quantity": "m11", "select": {"edges": ["x0"]}}, "q": {"quantity": "q1", "select": {"edges": ["x0"]}},
        "n": {"quantity": "n11", "select": {"edges": ["x0"]}},
        "low": {"quantity": "stress_11", "select": {"edges": ["x0"]}, "surface": "bottom"},
        "high": {"quantity": "stress_11", "select": {"edges": ["x0"]}},
        "long": {"quantity": "stretch_1", "select": {"edges": ["x0"]}, "surface": "bottom"},
        "f1": {"quantity": "frequency"}, "f2": {"quantity": "frequency", "mode": 2}}}})";
    return read_scene(path("strip.json"), overrides);
  }
};

TEST_F(ShellProbes, AreTheResultantsThatStaticsAsks) {
  const RunSummary summary = solve(cantilever());
  ASSERT_EQ(summary.status, Status::solved) << summary.message;
  // In the middle of the first cell; the end is lifted, so that the bottom is stretched.
  const double moment = -1e-5 * (10 - 0.25), stress = -6 * moment / 0.25;
  EXPECT_NEAR(value(summary, "m"), moment, 2e-3 * std::abs(moment));
  EXPECT_NEAR(value(summary, "q"), 1e-5, 2e-7);
  EXPECT_NEAR(value(summary, "n"), 0, 1e-7);
  EXPECT_NEAR(value(summary, "low"), stress, 2e-3 * stress);
  EXPECT_NEAR(value(summary, "high"), -stress, 2e-3 * stress);
  EXPECT_NEAR(value(summary, "long") - 1, stress / 96, 2e-3 * stress / 96);
}

TEST_F(ShellProbes, HaveNaturalFrequenciesAfterTheLastStep) {
  const RunSummary summary = solve(cantilever());
  const double unit = std::sqrt(1 / 0.5) / (2 * M_PI * 100);  // Timoshenko's beam of L/t = 20
  EXPECT_NEAR(value(summary, "f1"), 3.51025 * unit, 0.01 * 3.51025 * unit);
  EXPECT_NEAR(value(summary, "f2"), 21.7861 * unit, 0.01 * 21.7861 * unit);
  ASSERT_EQ(summary.modes.size(), 2u);
  EXPECT_LE(summary.modes[1].residual, 1e-8);
  EXPECT_THAT(summary.files, Contains("modes/strip_mode_00002.vtu"));
  const CheckReport report = check_run(path("out"), {});
  EXPECT_EQ(report.verdict(), CheckVerdict::within) << testing::PrintToString(report.findings);
}

TEST_F(ShellProbes, StallWhereThereAreFewerModesThanAreAskedFor) {
  const RunSummary summary = solve(cantilever({{"time.frequencies", "1000"}}));
  EXPECT_EQ(summary.status, Status::stalled);
  EXPECT_THAT(summary.message, HasSubstr("expected a count from 1 to"));
}

TEST_F(ShellProbes, WriteTheSameResultantsToFrames) {
  const RunSummary summary = solve(cantilever());
  const Frame frame = read_frame(path("out/frames/strip_00001.vtu"));
  const auto field = [&](const std::string& name) {
    const auto found = std::find_if(frame.cell_fields.begin(), frame.cell_fields.end(),
                                    [&](const Field& f) { return f.name == name; });
    return found == frame.cell_fields.end() ? Field{} : *found;
  };
  ASSERT_EQ(field("M").values.size(), 3 * 80u);
  // The two triangles of the first cell are the only ones that touch the clamped edge.
  EXPECT_NEAR((field("M").values[0] + field("M").values[3]) / 2, value(summary, "m"), 1e-12);
  EXPECT_EQ(field("M").values[0], field("M").values[3 * 40]);  // the same on the top
  EXPECT_NEAR((field("stress_0").values[0] + field("stress_0").values[6]) / 2, value(summary, "low"), 1e-10);
  EXPECT_EQ(field("Q").components, 2);
  EXPECT_EQ(field("stretches_0").components, 3);
}

}  // namespace
}  // namespace taut
