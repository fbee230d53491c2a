#include "problems/read_scene.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

namespace taut {
namespace {

namespace fs = std::filesystem;
using namespace scene;

class ReadScene : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// A problem with one body "cloth" of these further keys, and these sections.
  fs::path problem(const std::string& sections = "",
                   const std::string& body = R"("mesh": {"grid": {"size": [1, 2], "cells": [3, 4]}})") const {
    return write("p.json", R"({"format": 1, "time": {"integrator": "bdf2", "step": 0.5, "steps": 4},
      "bodies": {"cloth": {"thickness": 0.001, "density": 200, )" +
                               body + "}}" + (sections.empty() ? "" : ", ") + sections + "}");
  }
  std::string error(const fs::path& file, const Overrides& overrides = {}) const {
    try {
      read_scene(file, overrides);
    } catch (const InputError& e) {
      const std::string text = e.what();
      EXPECT_EQ(text.find('\n'), std::string::npos);
      EXPECT_EQ(text.find(file.string()), 0u);
      return text.substr(file.string().size() + 2);
    }
    return "no error";
  }

  fs::path folder_ = fs::temp_directory_path() / ("taut_read_scene_" + std::to_string(getpid()));
};

const std::string pin = R"("type": "pin", "body": "cloth", "select": {"all": true})";

TEST_F(ReadScene, DefaultsAreThoseOfTheStructs) {
  const Scene scene = read_scene(problem());
  EXPECT_EQ(scene.name, "p");
  EXPECT_EQ(scene.time.integrator, Integrator::bdf2);
  EXPECT_EQ(scene.time.step, 0.5);
  EXPECT_EQ(scene.time.spectral_radius, Time().spectral_radius);
  EXPECT_EQ(scene.gravity, Vector3::Zero());
  const Grid& grid = std::get<Grid>(scene.bodies.at(0).mesh);
  EXPECT_EQ(grid.size, Vector2(1, 2));
  EXPECT_EQ(grid.cells_x, 3);
  EXPECT_EQ(grid.cells_y, 4);
  EXPECT_FALSE(scene.bodies[0].membrane);
  EXPECT_FALSE(scene.bodies[0].bending);
  EXPECT_EQ(scene.bodies[0].mass, Mass::lumped);
  const scene::Solver defaults;
  EXPECT_EQ(scene.solver.tolerance.stationarity, defaults.tolerance.stationarity);
  EXPECT_EQ(scene.solver.tolerance.feasibility, defaults.tolerance.feasibility);
  EXPECT_EQ(scene.solver.tolerance.complementarity, defaults.tolerance.complementarity);
  EXPECT_EQ(scene.solver.penalty, defaults.penalty);
  EXPECT_EQ(scene.solver.penalty_growth, defaults.penalty_growth);
  EXPECT_EQ(scene.solver.max_outer, defaults.max_outer);
  EXPECT_EQ(scene.solver.max_newton, defaults.max_newton);
  EXPECT_EQ(scene.solver.inner_tolerance_factor, defaults.inner_tolerance_factor);
  EXPECT_EQ(scene.solver.on_failure, defaults.on_failure);
  EXPECT_EQ(scene.solver.method, defaults.method);
  EXPECT_EQ(scene.solver.ipopt.max_iterations, defaults.ipopt.max_iterations);
  EXPECT_EQ(scene.solver.ipopt.warm_start, defaults.ipopt.warm_start);
  EXPECT_EQ(scene.solver.nlopt.algorithm, defaults.nlopt.algorithm);
  EXPECT_EQ(scene.solver.nlopt.max_evaluations, defaults.nlopt.max_evaluations);
  EXPECT_EQ(scene.output.every, Output().every);
  EXPECT_EQ(scene.output.pictures, Output().pictures);
  EXPECT_FALSE(scene.output.view);
}

TEST_F(ReadScene, EveryKindArrivesWithItsValues) {
  write("rest.obj", "v 0 0 0\n");
  const Scene scene = read_scene(problem(
      R"("gravity": [0, 0, -9.81], "constraints": {
        "d": {"type": "sphere", "body": "cloth", "center": [1, 2, 3], "radius": 4,
              "select": {"box": {"min": [0, 0, 0], "max": [1, 1, 1]}}},
        "c": {"type": "half_space", "body": "cloth", "point": [1, 0, 0], "normal": [0, 0, 5],
              "select": {"nearest": [[1, 2, 3]]}},
        "b": {"type": "strain_limit", "body": "cloth", "form": "singular_values", "min": 0.9,
              "select": {"edges": ["y1"]}},
        "a": {"type": "pin", "body": "cloth", "axes": "xz", "select": {"vertices": [7]},
              "motion": {"axis": [0, 0, 2], "degrees_per_second": 90,
                         "keyframes": [{"time": 1}, {"time": 2, "degrees": 180}]}}},
      "loads": {"p": {"type": "pressure", "body": "cloth", "pressure": -3},
                "e": {"type": "edge_load", "body": "cloth",
                      "select": {"corners": ["x1y0"]}, "force_per_length": [0, 1, 0]}},
      "output": {"format": "none", "view": [0, -3, 0]})",
      R"("mesh": {"grid": {"size": [1, 2], "cells": [3, 4], "diagonals": "union_jack"}}, "mass": "consistent",
         "damping": {"stiffness": 0.1},
         "membrane": {"law": "neo_hookean", "young_modulus": 5, "poisson_ratio": -0.5}, "bending": {"stiffness": 2},
         "rest": {"from": "mesh", "file": "rest.obj", "scale": 0.5},
         "transform": {"scale": 2, "rotate": {"axis": [3, 0, 0], "degrees": 90}})"));
  ASSERT_EQ(scene.constraints.size(), 4u);
  EXPECT_EQ(scene.constraints[0].name, "a");
  const auto& a = std::get<Pin>(scene.constraints[0].kind);
  EXPECT_TRUE(a.x && !a.y && a.z);
  EXPECT_DOUBLE_EQ(a.motion.angular_velocity, std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(a.motion.keyframes.at(1).angle, std::numbers::pi);
  EXPECT_EQ(a.motion.axis, Vector3::UnitZ());
  EXPECT_EQ(std::get<ByIndex>(scene.constraints[0].select).vertices, std::vector<int>{7});
  const auto& b = std::get<StrainLimit>(scene.constraints[1].kind);
  EXPECT_EQ(b.form, LimitForm::singular_values);
  EXPECT_EQ(b.min, 0.9);
  EXPECT_FALSE(b.max);
  EXPECT_EQ(std::get<OnEdges>(scene.constraints[1].select).names, std::vector<std::string>{"y1"});
  EXPECT_EQ(std::get<HalfSpace>(scene.constraints[2].kind).normal, Vector3::UnitZ());
  EXPECT_EQ(std::get<NearestTo>(scene.constraints[2].select).points.at(0), Vector3(1, 2, 3));
  EXPECT_EQ(std::get<Sphere>(scene.constraints[3].kind).radius, 4);
  EXPECT_EQ(std::get<InBox>(scene.constraints[3].select).max, Vector3(1, 1, 1));
  EXPECT_EQ(std::get<EdgeLoad>(scene.loads.at(0).kind).force_per_length, Vector3(0, 1, 0));
  EXPECT_EQ(std::get<Pressure>(scene.loads.at(1).kind).pressure, -3);
  EXPECT_EQ(scene.output.format, FrameFormat::none);
  EXPECT_EQ(scene.output.view, Vector3(0, -1, 0));
  const Body& body = scene.bodies[0];
  EXPECT_EQ(std::get<Grid>(body.mesh).diagonals, Diagonals::union_jack);
  EXPECT_EQ(body.mass, Mass::consistent);
  EXPECT_EQ(body.membrane->law, MembraneLaw::neo_hookean);
  EXPECT_EQ(body.membrane->young_modulus, 5);
  EXPECT_EQ(body.membrane->poisson_ratio, -0.5);
  EXPECT_EQ(body.bending->stiffness, 2);
  EXPECT_EQ(body.damping.mass, 0);
  EXPECT_EQ(body.damping.stiffness, 0.1);
  EXPECT_EQ(body.rest.from, RestShape::mesh);
  EXPECT_EQ(body.rest.file, folder_ / "rest.obj");
  EXPECT_TRUE(body.transform(Vector3(0, 1, 0)).isApprox(Vector3(0, 0, 2)));
}

TEST_F(ReadScene, MotionIsPiecewiseLinearAndConstantOutside) {
  Motion motion;
  EXPECT_TRUE(motion.at_rest());
  const Vector3 x(0.1, 0.2, 0.3);
  EXPECT_EQ(motion.position(x, 5), x);
  motion.keyframes = {{1, {0, 0, 0}, 0}, {2, {0, 0, 1}, std::numbers::pi}, {4, {0, 0, 3}, std::numbers::pi}};
  motion.point = {1, 0, 0};
  EXPECT_FALSE(motion.at_rest());
  EXPECT_EQ(motion.position({2, 0, 0}, 0.5), Vector3(2, 0, 0));
  EXPECT_TRUE(motion.position({2, 0, 0}, 1.5).isApprox(Vector3(1, 1, 0.5), 1e-14));
  EXPECT_TRUE(motion.position({2, 0, 0}, 3).isApprox(Vector3(0, 0, 2), 1e-14));
  EXPECT_TRUE(motion.position({2, 0, 0}, 9).isApprox(Vector3(0, 0, 3), 1e-14));
  EXPECT_TRUE(motion.direction({1, 0, 0}, 1.5).isApprox(Vector3(0, 1, 0), 1e-14));
  motion.velocity = {0, 2, 0};
  EXPECT_TRUE(motion.position({1, 0, 0}, 3).isApprox(Vector3(1, 6, 2), 1e-14));
}

TEST_F(ReadScene, StaticNeedsNoStepAndRunsFromZeroToOne) {
  const Scene scene = read_scene(problem(), {{"time.integrator", "static"}});
  EXPECT_EQ(scene.time.integrator, Integrator::quasi_static);
  EXPECT_EQ(scene.time.step, 0.25);
  EXPECT_EQ(scene.hash, read_scene(problem(), {{"time.integrator", "static"}, {"time.step", "7"}}).hash);
}

TEST_F(ReadScene, CrossReferencesAreCheckedByPointer) {
  const auto constraint = [&](const std::string& text) {
    return error(problem(R"("constraints": {"k": {)" + text + "}}"));
  };
  EXPECT_EQ(constraint(R"("type": "strain_limit", "body": "cloht", "max": 1)"),
            "/constraints/k/body: found \"cloht\", allowed: cloth");
  EXPECT_EQ(constraint(R"("type": "strain_limit", "body": "cloth", "min": 1.2, "max": 1.1)"),
            "/constraints/k/min: found 1.2, allowed: a number <= max, which is 1.1");
  EXPECT_EQ(constraint(R"("type": "strain_limit", "body": "cloth")"),
            "/constraints/k: found neither \"min\" nor \"max\", allowed: at least one of them");
  EXPECT_EQ(constraint(R"("type": "half_space", "body": "cloth", "point": [0, 0, 0], "normal": [0, 0, 0])"),
            "/constraints/k/normal: found [0, 0, 0], allowed: a vector that is not zero");
  EXPECT_EQ(constraint(pin + R"(, "motion": {"degrees_per_second": 1})"),
            "/constraints/k/motion/axis: missing, allowed: a vector that is not zero (there is a rotation)");
  EXPECT_EQ(constraint(pin + R"(, "motion": {"keyframes": [{"time": 1}, {"time": 1}]})"),
            "/constraints/k/motion/keyframes/1/time: found 1.0, allowed: a number > the previous keyframe's, 1.0");
  EXPECT_EQ(constraint(R"("type": "pin", "body": "cloth", "select": {"box": {"min": [0, 2, 0], "max": [1, 1, 1]}})"),
            "/constraints/k/select/box/min/1: found 2.0, allowed: a number <= that of max, which is 1.0");
  EXPECT_EQ(error(write("p.json",
                        R"({"format": 1, "time": {"integrator": "bdf2", "steps": 1},
                  "bodies": {"b": {"thickness": 1, "density": 1,
                  "mesh": {"grid": {"size": [1, 1], "cells": [1, 1]}}}}})")),
            "/time/step: missing, allowed: a number > 0, in s (only \"static\" goes without)");
  EXPECT_EQ(error(write("p.json",
                        R"({"format": 1, "time": {"integrator": "static", "steps": 1},
                  "bodies": {"b": {"thickness": 1, "mesh": {"grid": {"size": [1, 1], "cells": [1, 1]}}}}})")),
            "/bodies/b/density: missing, allowed: a number > 0, in kg/m3");
  const auto probe = [&](const std::string& keys) {
    return error(problem(R"("output": {"probes": {"p": {)" + keys + "}}}"));
  };
  EXPECT_EQ(probe(R"("quantity": "x")"), "/output/probes/p/select: missing, allowed: a selection");
  EXPECT_EQ(probe(R"("quantity": "energy", "select": {"all": true})"),
            "/output/probes/p/select: found {\"all\":true}, allowed: none of it for \"energy\"");
  EXPECT_EQ(probe(R"("quantity": "energy", "expected": {"value": 1, "source": "s"})"),
            "/output/probes/p/expected: found neither of \"relative\" and \"absolute\", allowed: exactly one of them");
}

TEST_F(ReadScene, FilesAreFoundBesideTheProblemOrNamed) {
  const fs::path file = problem("", R"("mesh": {"file": "meshes/a.obj"})");
  EXPECT_EQ(error(file), "/bodies/cloth/mesh/file: found \"meshes/a.obj\", allowed: an existing file (looked for " +
                             (folder_ / "meshes/a.obj").string() + ")");
  write("meshes/a.obj", "v 0 0 0\n");
  const Scene scene = read_scene(file);
  EXPECT_EQ(std::get<MeshFile>(scene.bodies[0].mesh).path, folder_ / "meshes/a.obj");
  EXPECT_EQ(
      error(problem(R"("constraints": {"k": {"type": "pin", "body": "cloth", "select": {"edges": ["x0"]}}})",
                    R"("mesh": {"file": "meshes/a.obj"})")),
      "/constraints/k/select: found \"edges\" of a body with a mesh file, allowed: corners and edges of grids only");
  EXPECT_EQ(error(problem("", R"("mesh": {"file": "meshes/a.obj"}, "rest": {"from": "mesh"})")),
            "/bodies/cloth/rest/file: missing, allowed: a mesh file (\"from\" is \"mesh\")");
  EXPECT_EQ(error(folder_ / "none.json"), "no such file");
  EXPECT_EQ(error(folder_), "no such file");
}

TEST_F(ReadScene, TheElementsOfThickShellsAreRefusedOfCloth) {
  const std::string grid = R"("mesh": {"grid": {"size": [1, 2], "cells": [3, 4]}})";
  EXPECT_EQ(error(problem("", grid + R"(, "shell": {"element": "plain"})")),
            "/bodies/cloth/shell: found \"shell\", allowed: none of it, or its defaults, where \"model\" is \"cloth\"");
  EXPECT_EQ(read_scene(problem("", grid + R"(, "shell": {})")).bodies.size(), 1u);
}

TEST_F(ReadScene, OverridesAreJsonOrPlainWords) {
  const fs::path file = problem(R"("constraints": {"limit": {"type": "strain_limit", "body": "cloth", "max": 1.1}})");
  const Scene scene = read_scene(file, {{"constraints.limit.max", "1.05"},
                                        {"constraints.limit.form", "singular_values"},
                                        {"solver.tolerance.feasibility", "1e-9"},
                                        {"bodies.cloth.mesh.grid.cells", "[8, 9]"}});
  EXPECT_EQ(std::get<StrainLimit>(scene.constraints[0].kind).max, 1.05);
  EXPECT_EQ(std::get<StrainLimit>(scene.constraints[0].kind).form, LimitForm::singular_values);
  EXPECT_EQ(scene.solver.tolerance.feasibility, 1e-9);
  EXPECT_EQ(std::get<Grid>(scene.bodies[0].mesh).cells_y, 9);
}

TEST_F(ReadScene, AnOverrideOfNullTakesAKeyOut) {
  const fs::path file = problem(R"("constraints": {"limit": {"type": "strain_limit", "body": "cloth", "max": 1.1}})");
  EXPECT_TRUE(read_scene(file, {{"constraints.limit", "null"}}).constraints.empty());
  EXPECT_EQ(read_scene(file, {{"gravity", "null"}}).hash, read_scene(file).hash) << "its default takes its place";
  EXPECT_THROW(read_scene(file, {{"bodies.cloth.mesh", "null"}}), InputError) << "a key that has to be there";
}

TEST_F(ReadScene, OverridesOfNothingAreRefusedByName) {
  const fs::path file = problem();
  const auto refused = [&](const std::string& key, const std::string& value) {
    try {
      read_scene(file, {{key, value}});
    } catch (const InputError& e) {
      return std::string(e.what()).substr(file.string().size());
    }
    return std::string("no error");
  };
  EXPECT_EQ(refused("times.step", "1"),
            " --set times.step=1: /times: not there, so nothing can be set in it; allowed: format, time, bodies, "
            "description, look_for, gravity, "
            "constraints, loads, solver, output");
  EXPECT_EQ(refused("time.stepp", "1"),
            " --set time.stepp=1: /time/stepp: unknown key, allowed: integrator, step, steps, spectral_radius, beta, "
            "gamma, halvings, "
            "frequencies (did you mean \"step\"?)");
  EXPECT_EQ(refused("time.step", "1e999"),
            " --set time.step=1e999: /time/step: found \"1e999\", allowed: a number > 0, in s");
  EXPECT_EQ(refused("gravity.2", "1"),
            " --set gravity.2=1: /gravity: found no object, so \"2\" cannot be set in it; set \"gravity\" as a whole");
  EXPECT_EQ(refused("time.step.x.y", "1"),
            " --set time.step.x.y=1: /time/step/x: not there, so nothing can be set in it; allowed: nothing, as "
            "/time/step is no object");
  EXPECT_NE(refused("", "1").find("unknown key"), std::string::npos);
}

TEST_F(ReadScene, HashSeesOnlyWhatChangesTheResult) {
  const std::string a = R"({"format": 1, "time": {"integrator": "bdf2", "step": 0.5, "steps": 4}, "gravity": [0, 0, -1],
    "bodies": {"b": {"mesh": {"file": "m.obj"}, "thickness": 1, "density": 2}}})";
  const std::string same =
      R"({"name": "other", "description": "d", "output": {"every": 5}, "bodies": {"b": {"density": 2.0, /* comment */
    "thickness": 1e0, "mesh": {"file": "sub/n.obj"}, "mass": "lumped"}}, "gravity": [0.0, -0.0, -1], "constraints": {},
    "time": {"steps": 4, "step": 0.5, "integrator": "bdf2"}, "format": 1})";
  write("m.obj", "v 0 0 0\n");
  write("elsewhere/sub/n.obj", "v 0 0 0\n");
  const fs::path first = write("a.json", a);
  const std::string hash = read_scene(first).hash;
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(read_scene(write("elsewhere/b.json", same)).hash, hash);
  EXPECT_EQ(read_scene(write("elsewhere/c.json", read_scene(first).document)).hash, hash);
  EXPECT_NE(read_scene(first, {{"gravity", "[0, 0, -2]"}}).hash, hash);
  EXPECT_NE(read_scene(first, {{"solver.penalty", "11"}}).hash, hash);
  write("m.obj", "v 0 0 1\n");
  EXPECT_NE(read_scene(first).hash, hash);
}

TEST_F(ReadScene, EveryCatalogueFileIsAScene) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(TAUT_CATALOGUE)) {
    if (entry.path().extension() != ".json" || entry.path().filename() == "atlas.json") continue;  // of taut stress
    const Scene scene = read_scene(entry.path());
    EXPECT_EQ(scene.name, entry.path().stem().string());
    EXPECT_TRUE(!scene.constraints.empty() || scene.time.frequencies > 0) << scene.name;
    ++count;
  }
  EXPECT_GE(count, 10);
}

TEST_F(ReadScene, TheExampleOfTheReferencePageIsAScene) {
  std::ifstream stream(TAUT_SOURCE_DIR "/docs/reference/problem_format.md");
  const std::string page(std::istreambuf_iterator<char>(stream), {});
  const std::size_t begin = page.find("```json\n") + 8;
  const Scene scene = read_scene(write("example.json", page.substr(begin, page.find("```", begin) - begin)));
  EXPECT_EQ(std::get<AtCorners>(scene.constraints.at(0).select).names, std::vector<std::string>{"x0y1"});
}

}  // namespace
}  // namespace taut
