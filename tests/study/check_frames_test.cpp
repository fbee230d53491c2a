// A library of frames with one thing wrong, each of which the check must catch and name.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "files/atomic_file.h"
#include "files/obj.h"
#include "problems/build.h"
#include "problems/read_scene.h"
#include "study/check.h"
#include "study/frame_files.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A sheet of 4 x 4 cells in z = 0, held along x = 0, its stretch limited, above a floor and beside a ball that both
/// move.
class CheckFrames : public FilesTest {
 protected:
  CheckFrames() {
    std::ofstream(path("sheet.json")) << R"({
      "format": 1,
      "time": { "integrator": "implicit_euler", "step": 0.1, "steps": 10 },
      "gravity": [0, 0, -9.81],
      "bodies": { "sheet": {
        "mesh": { "grid": { "size": [1, 1], "cells": [4, 4], "diagonals": "right" } }, "thickness": 0.001, "density": 200,
        "membrane": { "law": "stvk", "young_modulus": 8000, "poisson_ratio": 0.25 } } },
      "constraints": {
        "held": { "type": "pin", "body": "sheet", "select": { "edges": ["x0"] }, "motion": { "velocity": [0, 1, 0] } },
        "limit": { "type": "strain_limit", "body": "sheet", "min": 0.9, "max": 1.1 },
        "floor": { "type": "half_space", "body": "sheet", "point": [0, 0, -1], "normal": [0, 0, 1],
          "motion": { "velocity": [0, 0, 0.5] } },
        "ball": { "type": "sphere", "body": "sheet", "center": [0.5, 0.5, 1.2], "radius": 0.5,
          "motion": { "velocity": [0, 1, 0] } } },
      "solver": {} })";
    scene_ = read_scene(path("sheet.json"));
    model_ = build_model(scene_);
  }
  /// The sheet at rest, moved along with its pins.
  Vector sheet(double time = 0) const {
    Vector x = model_->positions;
    for (Index v = 0; v < x.size() / 3; ++v) x[3 * v + 1] += time;
    return x;
  }
  void write(const std::string& name, const Vector& x) { write_obj(path(name), x, model_->triangles); }
  void write(const std::string& name, const std::string& text) { write_atomically(path(name), text); }
  CheckReport check(FrameOptions options = {}) {
    if (options.patterns.empty()) options.patterns = {path("f_*").string()};
    return check_frames(scene_, options);
  }
  /// The only finding of a single frame of step 0.
  std::string finding(const Vector& x) {
    write("f_0.obj", x);
    const CheckReport report = check();
    EXPECT_THAT(report.unusable, IsEmpty());
    EXPECT_EQ(report.verdict(), CheckVerdict::outside);
    EXPECT_EQ(report.findings.size(), 1u) << testing::PrintToString(report.findings);
    return report.findings.empty() ? "" : report.findings[0];
  }
  static Vector3 at(const Vector& x, int vertex) { return x.segment<3>(3 * vertex); }
  /// What `f_0.obj` with this change is refused for.
  std::string refusal(const std::function<void(Vector&, std::vector<Triangle>&)>& change) {
    Vector x = sheet();
    std::vector<Triangle> triangles = model_->triangles;
    change(x, triangles);
    write_obj(path("f_0.obj"), x, triangles);
    const CheckReport report = check();
    EXPECT_EQ(report.verdict(), CheckVerdict::unusable);
    return report.unusable.empty() ? "" : report.unusable[0];
  }

  Scene scene_;
  std::unique_ptr<Model> model_;
};

TEST_F(CheckFrames, FramesThatMeetEverythingPass) {
  for (int step = 0; step <= 10; ++step) write("f_" + std::to_string(step) + ".obj", sheet(0.1 * step));
  const CheckReport report = check();
  EXPECT_EQ(report.verdict(), CheckVerdict::within) << testing::PrintToString(report.findings);
  ASSERT_EQ(report.frames.size(), 11u);
  for (int step = 0; step <= 10; ++step) {
    EXPECT_EQ(report.frames[static_cast<std::size_t>(step)].number, step) << "2 comes before 10";
    EXPECT_DOUBLE_EQ(report.frames[static_cast<std::size_t>(step)].time, 0.1 * step);
  }
  std::vector<std::string> names;
  for (const Verdict& verdict : report.worst) names.push_back(verdict.constraint);
  EXPECT_THAT(names, ElementsAre("ball", "floor", "limit", "pins", "inverted faces", "degenerate faces"));
}

TEST_F(CheckFrames, AStretchedEdgeIsNamedWithItsTriangle) {
  Vector x = sheet();
  x[3 * 24] += 0.05;  // the corner of the last cell, in its upper triangle or both
  write("f_0.obj", x);
  const CheckReport report = check();
  EXPECT_EQ(report.verdict(), CheckVerdict::outside);
  const Verdict& limit = report.worst.at(2);
  EXPECT_EQ(limit.constraint, "limit");
  EXPECT_GT(limit.max, 0.09);
  EXPECT_THAT(limit.where, testing::AnyOf(HasSubstr("triangle 30 of sheet"), HasSubstr("triangle 31 of sheet")));
  EXPECT_EQ(limit.elements, 32);
  EXPECT_GE(limit.violated, 1);
  EXPECT_LE(limit.violated, 2);
  EXPECT_THAT(report.findings, Contains(HasSubstr("limit: ")));
}

TEST_F(CheckFrames, APinThatSlippedIsNamed) {
  Vector x = sheet();
  x[3 * 10] -= 1e-3;
  EXPECT_THAT(finding(x), HasSubstr("pins: 0.001 at vertex 10 of sheet, frame 0, allowed is 1.41e-06"));
}

TEST_F(CheckFrames, AVertexBelowTheFloorOfThatTimeIsNamed) {
  Vector x = sheet(1.0);
  for (Index v = 0; v < x.size() / 3; ++v) {
    if (x[3 * v] > 0) x[3 * v + 2] -= 0.45;
  }
  write("f_10.obj", x);
  const CheckReport fine = check();
  EXPECT_TRUE(fine.worst.at(1).within()) << "the floor is at -0.5 then";
  x[3 * 12 + 2] = -0.53;
  write("f_10.obj", x);
  const CheckReport report = check();
  EXPECT_EQ(report.worst.at(1).violated, 1);
  EXPECT_NEAR(report.worst.at(1).max, 0.03, 1e-12);
  EXPECT_EQ(report.worst.at(1).where, "vertex 12 of sheet, frame 10");
}

TEST_F(CheckFrames, AVertexInsideTheSphereOfThatTimeIsNamed) {
  Vector x = sheet(0.5);
  const Vector3 center(0.5, 1.0, 1.2);
  x.segment<3>(3 * 12) = center + Vector3(0, 0, -0.48);
  write("f_5.obj", x);
  const CheckReport report = check();
  EXPECT_EQ(report.worst.at(0).violated, 1);
  EXPECT_NEAR(report.worst.at(0).max, 0.02, 1e-12);
  EXPECT_EQ(report.worst.at(0).where, "vertex 12 of sheet, frame 5");
}

TEST_F(CheckFrames, AnInvertedTriangleIsNamed) {
  scene_ = read_scene(path("sheet.json"), {{"constraints.limit.max", "100"}, {"constraints.limit.min", "0"}});
  model_ = build_model(scene_);
  Vector x = sheet();
  // Vertex 12 in the middle crosses the edge from 7 to 13, opposite to it in the triangle 7, 13, 12.
  x.segment<3>(3 * 12) = 0.5 * (at(x, 7) + at(x, 13)) + 0.2 * (0.5 * (at(x, 7) + at(x, 13)) - at(x, 12));
  std::string name;
  for (std::size_t t = 0; t < model_->triangles.size(); ++t) {
    Triangle sorted = model_->triangles[t];
    std::sort(sorted.begin(), sorted.end());
    if (sorted == Triangle{7, 12, 13}) name = "triangle " + std::to_string(t) + " of sheet";
  }
  ASSERT_NE(name, "") << "the diagonals run from lower left to upper right";
  EXPECT_THAT(finding(x), HasSubstr("inverted faces: 180 at " + name + ", frame 0, allowed is 150"));
}

TEST_F(CheckFrames, AFoldAlongOneLineIsNoInversion) {
  Vector x = sheet();
  for (Index v = 0; v < x.size() / 3; ++v) {
    if (x[3 * v] > 0.5) x[3 * v] = 1.0 - x[3 * v], x[3 * v + 2] = 1e-3;  // folded back onto itself
  }
  write("f_0.obj", x);
  EXPECT_TRUE(check().worst.at(4).within()) << check().worst.at(4).max;
}

TEST_F(CheckFrames, TheAngleOfAnInversionCanBeSet) {
  Vector x = sheet();
  x.segment<3>(3 * 12) += Vector3(0.05, -0.05, 0.4);  // a spike
  write("f_0.obj", x);
  const double angle = check().worst.at(4).max;
  EXPECT_GT(angle, 30);
  EXPECT_LT(angle, 150);
  FrameOptions strict;
  strict.largest_fold = angle - 1;
  EXPECT_FALSE(check(strict).worst.at(4).within());
  strict.largest_fold = angle + 1;
  EXPECT_TRUE(check(strict).worst.at(4).within());
}

TEST_F(CheckFrames, ADegenerateFaceIsNamed) {
  Vector x = sheet();
  const Triangle t = model_->triangles[20];
  x.segment<3>(3 * t[2]) = 0.5 * (at(x, t[0]) + at(x, t[1]));
  write("f_0.obj", x);
  const CheckReport report = check();
  EXPECT_THAT(report.findings, Contains(HasSubstr("degenerate faces: ")));
  EXPECT_EQ(report.worst.at(5).where, "triangle 20 of sheet, frame 0");
  EXPECT_EQ(report.worst.at(5).violated, 1);
}

TEST_F(CheckFrames, AFaceWithoutAnyAreaIsDegenerateAndNothingIsANan) {
  write("f_0.obj", Vector(Vector::Zero(75)));
  const CheckReport report = check();
  EXPECT_EQ(report.worst.at(5).violated, 32);
  EXPECT_TRUE(std::isinf(report.worst.at(5).max));
  EXPECT_FALSE(std::isnan(report.worst.at(4).max));
}

TEST_F(CheckFrames, ANanIsNamed) {
  write("f_0.obj", sheet());
  Frame frame{0, sheet(0.1), model_->triangles, {}, {}};
  frame.positions[3 * 7 + 1] = std::numeric_limits<double>::quiet_NaN();
  write_vtu(path("f_1.vtu"), frame);
  EXPECT_THAT(check().unusable, ElementsAre(HasSubstr("f_1.vtu: vertex 7 of sheet is not finite")));
  EXPECT_EQ(check().frames.size(), 1u) << "the others are judged all the same";
  std::string text = read_bytes(path("f_0.obj"));
  text.replace(text.find("0.25"), 4, "nan");
  write("f_0.obj", text);
  EXPECT_THAT(check().unusable, Contains(HasSubstr("f_0.obj:2: \"nan\" is not a finite number")));
}

TEST_F(CheckFrames, AnotherNumberOfVerticesIsNamed) {
  EXPECT_THAT(refusal([](Vector& x, auto&) {
                x.conservativeResize(78);
                x.tail<3>().setZero();
              }),
              HasSubstr("f_0.obj: has 26 vertices, the scene has 25"));
}

TEST_F(CheckFrames, WrongFacesAreNamed) {
  EXPECT_THAT(refusal([](auto&, std::vector<Triangle>& t) { std::swap(t[17][0], t[17][1]); }),
              HasSubstr("triangle 17 of sheet (vertices "));
  EXPECT_THAT(refusal([](auto&, std::vector<Triangle>& t) { std::swap(t[17][0], t[17][1]); }),
              HasSubstr("is turned over in face 17"));
  EXPECT_THAT(refusal([](auto&, std::vector<Triangle>& t) {
                t[3] = {0, 12, 24};
              }),
              HasSubstr("is not among the faces; face 3 has the vertices 0, 12, 24"));
  EXPECT_THAT(refusal([](auto&, std::vector<Triangle>& t) { t.resize(30); }),
              HasSubstr("is not among the faces; 1 more triangles of the scene are not there"));
  EXPECT_THAT(refusal([](auto&, std::vector<Triangle>& t) {
                t.push_back({0, 12, 24});
              }),
              HasSubstr("has 33 faces, the scene has 32 triangles"));
}

TEST_F(CheckFrames, FacesMayComeInAnotherOrderAndStartAtAnotherCorner) {
  std::vector<Triangle> triangles = model_->triangles;
  std::swap(triangles[3], triangles[20]);
  std::rotate(triangles[5].begin(), triangles[5].begin() + 1, triangles[5].end());
  write_obj(path("f_0.obj"), sheet(), triangles);
  EXPECT_EQ(check().verdict(), CheckVerdict::within);
}

TEST_F(CheckFrames, PlyFilesAreRead) {
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 25\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 32\nproperty list uchar int vertex_indices\nend_header\n";
  const Vector x = sheet();
  for (int v = 0; v < 25; ++v) {
    for (int axis = 0; axis < 3; ++axis) ply += std::to_string(x[3 * v + axis]) + (axis < 2 ? " " : "\n");
  }
  for (const Triangle& t : model_->triangles) {
    ply += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
  }
  write("f_0.ply", ply);
  EXPECT_EQ(check().verdict(), CheckVerdict::within) << testing::PrintToString(check().unusable);
}

TEST_F(CheckFrames, StlAndUnknownFilesAreRefused) {
  write("f_0.stl", "solid");
  EXPECT_THAT(check().unusable, ElementsAre(HasSubstr("STL files do not keep the order of vertices")));
  fs::remove(path("f_0.stl"));
  write("f_0.abc", "x");
  EXPECT_THAT(check().unusable, ElementsAre(HasSubstr("f_0.abc: unknown kind of mesh file")));
}

TEST_F(CheckFrames, TimesFollowFromTheNumbersAsStated) {
  write("f_20.obj", sheet(0.5));
  write("f_22.obj", sheet(1.0));
  FrameOptions options;
  options.first_time = 0.5;
  options.step = 0.25;
  const CheckReport report = check(options);
  EXPECT_EQ(report.verdict(), CheckVerdict::within) << testing::PrintToString(report.findings);
  EXPECT_DOUBLE_EQ(report.frames.at(1).time, 1.0);
  EXPECT_DOUBLE_EQ(check().frames.at(1).time, 2.2) << "without them the number is the step";
  options.step.reset();
  EXPECT_DOUBLE_EQ(check(options).frames.at(1).time, 0.7);
}

class FindFrames : public FilesTest {
 protected:
  /// Numbers that were found in files f_N.obj; what is wrong goes to problems_.
  std::vector<int> numbers(const std::vector<std::string>& names, std::vector<std::string> patterns = {"*"}) {
    fs::remove_all(path("in"));
    fs::create_directory(path("in"));
    for (const std::string& name : names) write_atomically(path("in") / name, "");
    for (std::string& pattern : patterns) pattern = (path("in") / pattern).string();
    const FrameList list = find_frames(patterns);
    problems_ = list.problems;
    std::vector<int> found;
    for (const FrameFile& file : list.files) found.push_back(file.number);
    return found;
  }
  std::vector<std::string> problems_;
};

TEST_F(FindFrames, ComeInTheOrderOfTheirNumbers) {
  EXPECT_THAT(numbers({"f_10.obj", "f_9.obj", "f_0011.obj", "f_8.obj"}), ElementsAre(8, 9, 10, 11));
  EXPECT_THAT(problems_, IsEmpty());
  EXPECT_THAT(numbers({"f1.obj", "f2.obj", "f1.ply"}, {"*.obj"}), ElementsAre(1, 2));
  EXPECT_THAT(numbers({"f1.obj", "f2.obj"}, {"f2.obj", "f1.obj", "*.obj"}), ElementsAre(1, 2));
  EXPECT_THAT(numbers({"b.obj", "a.obj"}), ElementsAre(0, 1));
  EXPECT_THAT(problems_, IsEmpty());
}

TEST_F(FindFrames, GapsAreNamed) {
  numbers({"f_0.obj", "f_1.obj", "f_3.obj", "f_4.obj", "f_8.obj"});
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("frame 2 is missing between"),
                                     HasSubstr("3 frames from 5 on are missing between")));
  numbers({"f_0.obj", "f_10.obj", "f_20.obj", "f_40.obj", "f_50.obj"});
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("frame 30 is missing between")));
  for (const auto& whole : {std::vector<std::string>{"f_0.obj", "f_3.obj", "f_6.obj", "f_8.obj"},
                            {"f_0.obj", "f_10.obj", "f_15.obj"},
                            {"f_7.obj"},
                            {"f_0.obj", "f_5.obj"}}) {
    numbers(whole);
    EXPECT_THAT(problems_, IsEmpty()) << whole.back();
  }
}

TEST_F(FindFrames, PatternsThatMatchNothingAndNumbersInDoubtAreNamed) {
  EXPECT_THAT(numbers({"f_0.obj"}, {"g*", "f_1.obj"}), IsEmpty());
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("g*: no file matches"), HasSubstr("f_1.obj: no file matches")));
  numbers({"a_0.obj", "b_0.obj"});
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("two frames with the number 0")));
  numbers({"a_0.obj", "rest.obj"});
  EXPECT_THAT(problems_, ElementsAre(HasSubstr("rest.obj: no number at the end of its name")));
}

TEST_F(CheckFrames, PercentilesAndSharesAreThoseOfTheDefinition) {
  // 99 vertices at 0, one each at 1 mm and 2 mm outside: 99 % of 101 is 99.99, so the 100th value.
  std::ofstream(path("row.json")) << R"({
    "format": 1, "time": { "integrator": "implicit_euler", "step": 0.1, "steps": 1 }, "gravity": [0, 0, 0],
    "bodies": { "row": { "mesh": { "grid": { "size": [100, 1], "cells": [100, 1] } }, "thickness": 1, "density": 1 } },
    "constraints": { "floor": { "type": "half_space", "body": "row", "select": { "edges": ["y0"] },
      "point": [0, 0, 0], "normal": [0, 0, 1] } },
    "solver": {} })";
  scene_ = read_scene(path("row.json"));
  model_ = build_model(scene_);
  Vector x = model_->positions;
  x[3 * 40 + 2] = -1e-3;
  x[3 * 60 + 2] = -2e-3;
  write("f_0.obj", x);
  FrameOptions options;
  options.tolerance = 1.5e-3 / std::hypot(100.0, 1.0);
  const Verdict floor = check(options).worst.at(0);
  EXPECT_EQ(floor.elements, 101);
  EXPECT_EQ(floor.max, 2e-3);
  EXPECT_EQ(floor.percentile99, 1e-3);
  EXPECT_EQ(floor.violated, 1);
  EXPECT_EQ(floor.where, "vertex 60 of row, frame 0");
}

}  // namespace
}  // namespace taut
