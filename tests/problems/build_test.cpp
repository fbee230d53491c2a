#include "problems/build.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "constraints/obstacle.h"
#include "problems/read_scene.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

/// A scene in one file: one grid body "cloth" of 1 m x 2 m and 2 x 4 cells unless said otherwise, density 200 kg/m3 x 1
/// mm.
class Build : public FilesTest {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  Scene scene(const std::string& sections = "", const std::string& body = "", const std::string& mesh = grid) const {
    return read_scene(
        write("p.json",
              R"({"format": 1, "time": {"integrator": "implicit_euler", "step": 0.01, "steps": 4}, "bodies": {"cloth": {
      "thickness": 0.001, "density": 200, "mesh": )" +
                  mesh + (body.empty() ? "" : ", ") + body + "}}" + (sections.empty() ? "" : ", ") + sections + "}"));
  }
  /// The message without the file it starts with.
  std::string error(const Scene& scene) const {
    try {
      build_model(scene);
    } catch (const InputError& e) {
      const std::string text = e.what();
      EXPECT_EQ(text.find('\n'), std::string::npos);
      EXPECT_EQ(text.find(scene.source + ": "), 0u) << text;
      return text.substr(scene.source.size() + 2);
    }
    return "no error";
  }

  static constexpr const char* grid = R"({"grid": {"size": [1, 2], "cells": [2, 4], "diagonals": "left"}})";
  static constexpr const char* membrane = R"("membrane": {"law": "stvk", "young_modulus": 1000, "poisson_ratio": 0.3})";
  static constexpr const char* tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
};

std::vector<std::string> names_of(const Model& model) {
  std::vector<std::string> names;
  for (const auto& energy : model.inertia) names.push_back(energy->name());
  for (const auto& energy : model.elastic) names.push_back(energy->name());
  for (const auto& damping : model.stiffness_damping) names.push_back(damping.energy->name());
  for (const auto& load : model.dead_loads) names.push_back(load->name());
  for (const auto& pressure : model.pressures) names.push_back(pressure->name());
  for (const auto& load : model.lagged_loads) names.push_back(load.energy->name());
  for (const auto& constraint : model.constraints) names.push_back(constraint->name());
  return names;
}

double value_of(const Energy& energy, const Vector& x) {
  double sum = 0;
  std::vector<double> local(max_stencil_width);
  for (Index e = 0; e < energy.stencils().count(); ++e) {
    energy.stencils().gather(e, x, local.data());
    sum += energy.evaluate(e, local.data(), nullptr, nullptr, Curvature::exact);
  }
  return sum;
}

/// Its forces on all vertices, N.
Eigen::Matrix3Xd forces_of(const Energy& energy, const Vector& x) {
  Vector sum = Vector::Zero(x.size());
  std::vector<double> local(max_stencil_width), gradient(max_stencil_width);
  for (Index e = 0; e < energy.stencils().count(); ++e) {
    energy.stencils().gather(e, x, local.data());
    energy.evaluate(e, local.data(), gradient.data(), nullptr, Curvature::exact);
    for (int i = 0; i < energy.stencils().width(); ++i) sum[energy.stencils()[e][i]] -= gradient[i];
  }
  return Eigen::Map<Eigen::Matrix3Xd>(sum.data(), 3, sum.size() / 3);
}

/// Overrides that make a catalogue's scene small: fewer cells, and its cover (the body behind its shell) at ratio 2.
Overrides small_grid(const std::string& name) {
  const Scene full = read_scene(fs::path(TAUT_CATALOGUE) / (name + ".json"));
  if (!std::holds_alternative<scene::Grid>(full.bodies.at(0).mesh)) return {};
  const auto& grid = std::get<scene::Grid>(full.bodies[0].mesh);
  const int across = std::min(grid.cells_x, 8);
  const int along = std::max(1, static_cast<int>(std::lround(across * grid.size.y() / grid.size.x())));
  const std::string body = "bodies." + full.bodies[0].name;
  Overrides overrides{
      {body + ".mesh.grid.cells", "[" + std::to_string(across) + ", " + std::to_string(std::min(along, 12)) + "]"}};
  if (full.bodies.size() > 1 && full.bodies[1].cover) overrides.emplace_back(body + ".cover.mesh.refine", "1");
  return overrides;
}

class Catalogue : public testing::TestWithParam<std::string> {};

std::vector<std::string> catalogue_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(TAUT_CATALOGUE))
    if (entry.is_regular_file()) names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Catalogue, testing::ValuesIn(catalogue_names()),
                         [](const auto& scene) { return scene.param; });

TEST_P(Catalogue, BuildsAndSolvesItsFirstSteps) {
  const fs::path file = fs::path(TAUT_CATALOGUE) / (GetParam() + ".json");
  EXPECT_NO_THROW(build_model(read_scene(file))) << "at full size";
  const Scene scene = read_scene(file, small_grid(GetParam()));
  const std::unique_ptr<Model> model = build_model(scene);
  Stepper stepper(*model, time_options(scene));
  const std::unique_ptr<Solver> solver = build_solver(scene, 1);
  for (int step = 1; step <= 2; ++step) {
    const Problem& problem = stepper.prepare();
    const Result result = solver->solve(problem, stepper.state().warm, Budget{});
    const bool infeasible = GetParam() == "infeasible_pins" && step > 1;
    EXPECT_EQ(result.status, infeasible ? Status::infeasible : Status::solved)
        << "step " << step << ": " << result.message;
    EXPECT_EQ(residuals(problem, result).within(scene.solver.tolerance), !infeasible);
    stepper.accept(result);
  }
}

TEST_F(Build, AssemblesExactlyWhatTheSceneNames) {
  EXPECT_THAT(names_of(*build_model(scene())), ElementsAre("inertia of cloth"));
  const Scene all =
      scene(R"("gravity": [0, 0, -10],
      "constraints": {"hold": {"type": "pin", "body": "cloth", "select": {"boundary": true}},
                      "floor": {"type": "half_space", "body": "cloth", "point": [0, 0, -1], "normal": [0, 0, 2]},
                      "limit": {"type": "strain_limit", "body": "cloth", "max": 1.1, "form": "singular_values"}},
      "loads": {"air": {"type": "wind", "body": "cloth", "velocity": [0, 0, 3]},
                "push": {"type": "pressure", "body": "cloth", "pressure": 4},
                "pull": {"type": "point_load", "body": "cloth", "select": {"all": true}, "force": [1, 0, 0]}})",
            std::string(membrane) + R"(, "bending": {"stiffness": 1e-5}, "damping": {"mass": 0.5, "stiffness": 0.01})");
  const auto model = build_model(all);
  EXPECT_THAT(names_of(*model),
              ElementsAre("inertia of cloth", "membrane of cloth", "bending of cloth", "damping of membrane of cloth",
                          "damping of bending of cloth", "gravity", "pull", "push", "air", "floor", "limit"));
  EXPECT_EQ(model->mass_damping[0], 0.5);
  EXPECT_EQ(model->stiffness_damping[1].beta, 0.01);
  EXPECT_EQ(model->pins.size(), 3u * 12);
  EXPECT_TRUE(model->movers.empty());
  EXPECT_EQ(model->constraints[1]->rows(), 2);
}

TEST_F(Build, GravityIsTheWeightWithEitherMass) {
  for (const char* mass : {"lumped", "consistent"}) {
    const auto model = build_model(scene(R"("gravity": [0, 1, -10])", std::string(R"("mass": ")") + mass + "\""));
    const Vector3 total = forces_of(*model->dead_loads[0], model->positions).rowwise().sum();
    EXPECT_NEAR(total.y(), 2 * 0.2, 1e-12);
    EXPECT_NEAR(total.z(), -10 * 2 * 0.2, 1e-12);
    EXPECT_NEAR(model->inertia[0]->kinetic_energy(Vector::Ones(model->positions.size())), 0.5 * 2 * 0.2 * 3, 1e-12)
        << mass;
  }
}

TEST_F(Build, BodiesFollowOneAnother) {
  const fs::path file = write("two.json", R"({"format": 1, "time": {"integrator": "static", "steps": 4}, "bodies": {
      "a": {"thickness": 1, "density": 1, "mesh": {"grid": {"size": [1, 1], "cells": [1, 1]}}, "initial_velocity": [1, 2, 3]},
      "b": {"thickness": 1, "density": 1, "mesh": {"grid": {"size": [1, 1], "cells": [2, 2]}}, "transform": {"scale": 3, "translate": [0, 0, 4]},
            "membrane": {"law": "neo_hookean", "young_modulus": 1000, "poisson_ratio": 0.3}, "bending": {"stiffness": 1}}},
      "constraints": {
        "pin": {"type": "pin", "body": "b", "axes": "yz", "select": {"corners": ["x1y1"]}},
        "limit": {"type": "strain_limit", "body": "b", "min": 0.9, "select": {"box": {"min": [0, 0, 3], "max": [1.6, 1.6, 5]}}},
        "ball": {"type": "sphere", "body": "b", "center": [0, 0, 9], "radius": 1, "motion": {"velocity": [0, 0, 1]}, "select": {"vertices": [0]}}}})");
  const Scene two = read_scene(file);
  const auto model = build_model(two);
  ASSERT_EQ(model->bodies.size(), 2u);
  EXPECT_EQ(model->bodies[1].name, "b");
  EXPECT_EQ(model->bodies[1].first_vertex, 4);
  EXPECT_EQ(model->bodies[1].vertices, 9);
  EXPECT_EQ(model->bodies[1].first_triangle, 2);
  EXPECT_EQ(model->triangles.size(), 2u + 8);
  EXPECT_EQ(model->triangles[2][0], 4);
  EXPECT_EQ(model->positions.tail<3>(), Vector3(3, 3, 4));
  EXPECT_EQ(model->velocities.head<3>(), Vector3(1, 2, 3));
  EXPECT_EQ(model->velocities.tail<3>(), Vector3::Zero());
  ASSERT_EQ(model->pins.size(), 2u);
  EXPECT_EQ(model->pins[0].variable, 3 * 12 + 1);
  EXPECT_EQ(model->pins[1].value(0.3), 4);
  EXPECT_NEAR(value_of(*model->elastic[0], model->positions), 0, 1e-12);
  EXPECT_NEAR(value_of(*model->elastic[1], model->positions), 0, 1e-12);
  const Constraint &ball = *model->constraints[0], &limit = *model->constraints[1];
  EXPECT_EQ(ball.stencils()[0][0], 12);
  EXPECT_EQ(ball.element_name(0), "vertex 0 of b");
  EXPECT_NEAR(ball.violation_scale(), std::sqrt(9 + 9 + 16), 1e-12);
  EXPECT_EQ(limit.stencils().count(), 2) << "the triangles of the first cell";
  EXPECT_EQ(limit.element_name(1), "triangle 1 of b");
  const auto gap = [&] {
    double value = 0;
    ball.evaluate(0, model->positions.data() + 12, &value, nullptr);
    return value;
  };
  EXPECT_NEAR(gap(), 5 - 1, 1e-12) << "placed at time 0 though nothing has moved it";
  ASSERT_EQ(model->movers.size(), 1u);
  model->movers[0](2.0);
  EXPECT_NEAR(gap(), 7 - 1, 1e-12);

  EXPECT_EQ(time_options(two).integrator, Integrator::quasi_static);
  EXPECT_EQ(time_options(two).steps, 4);
}

TEST_F(Build, RestShapesComeFromTheirSources) {
  const std::string elastic = std::string(membrane) + R"(, "bending": {"stiffness": 1})";
  const auto energies = [&](const std::string& rest, const std::string& mesh = grid, const std::string& more = "") {
    const auto model = build_model(scene("", elastic + R"(, "rest": )" + rest + more, mesh));
    return std::pair(value_of(*model->elastic[0], model->positions), value_of(*model->elastic[1], model->positions));
  };
  const auto scaled = energies(R"({"scale": 0.5})");
  const double strain = 1.5, lambda = 1000 * 0.3 / 0.91, mu = 1000 / 2.6;  // Green strain of a stretch of 2
  EXPECT_NEAR(scaled.first, 0.001 * 0.5 * (2 * mu + 2 * lambda) * strain * strain, 1e-9)
      << "on half the lengths, a quarter of the area";
  EXPECT_NEAR(scaled.second, 0, 1e-20);

  const std::string twice = R"(, "transform": {"scale": 2})";
  EXPECT_NEAR(energies(R"({"from": "uv"})", grid, twice).first, 4 * scaled.first, 1e-8)
      << "uv are not scaled with the positions";
  EXPECT_NEAR(energies(R"({"from": "initial"})", grid, twice).first, 0, 1e-12);

  write("roof.obj", "v 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nf 1 2 3\nf 1 3 4\n");
  write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -1 0 0\nf 1 2 3\nf 1 3 4\n");
  const std::string roof = R"({"file": "roof.obj"})";
  EXPECT_NEAR(energies(R"({"from": "initial"})", roof).second, 0, 1e-20) << "its own dihedral angle is at rest";
  EXPECT_GT(energies(R"({"from": "mesh", "file": "flat.obj"})", roof).second, 0.1);

  write("sewn.obj",
        "v 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nvt 0 0\nvt 1 0\nvt 0 1\nvt 5 5\nvt 5 6\nvt 4 5\nf 1/1 2/2 3/3\nf 1/4 3/5 "
        "4/6\n");
  const auto flat = energies(R"({"from": "mesh", "file": "flat.obj"})", roof),
             sewn = energies(R"({"from": "uv"})", R"({"file": "sewn.obj"})");
  EXPECT_NEAR(sewn.first, flat.first, 1e-9) << "the same flat pieces, apart in uv";
  EXPECT_NEAR(sewn.second, flat.second, 1e-12) << "bent over the seam";
}

TEST_F(Build, LoadsAddUpToTheirForces) {
  const auto model = build_model(scene(R"("loads": {
      "edge": {"type": "edge_load", "body": "cloth", "select": {"edges": ["x0", "y0"]}, "force_per_length": [0, 0, 3]},
      "point": {"type": "point_load", "body": "cloth", "select": {"corners": ["x0y0", "x1y1"]}, "force": [2, 0, 0]}})",
                                       R"("rest": {"scale": 2})"));
  const Eigen::Matrix3Xd edge = forces_of(*model->dead_loads[0], model->positions),
                         point = forces_of(*model->dead_loads[1], model->positions);
  EXPECT_NEAR(edge.row(2).sum(), 3 * 2 * (1 + 2), 1e-12) << "along the rest lengths";
  EXPECT_NEAR(edge(2, 0), 3 * 0.5 * (1 + 1), 1e-12) << "half of each edge at the corner";
  EXPECT_EQ(point(0, 0), 2);
  EXPECT_EQ(point.row(0).sum(), 4);
}

TEST_F(Build, PressureHasAPotentialWhereTheBoundaryIsClosedOrFixed) {
  const std::string pressure = R"("loads": {"gas": {"type": "pressure", "body": "cloth", "pressure": 6}})";
  write("tetrahedron.obj", tetrahedron);
  const auto closed = build_model(scene(pressure, "", R"({"file": "tetrahedron.obj"})"));
  EXPECT_NEAR(value_of(*closed->pressures[0], closed->positions), -6.0 / 6, 1e-12) << "- p V";
  EXPECT_TRUE(closed->notes.empty());
  const auto open = build_model(scene(pressure));
  EXPECT_TRUE(open->pressures.empty());
  EXPECT_EQ(open->lagged_loads.size(), 1u);
  EXPECT_THAT(open->notes, testing::ElementsAre(HasSubstr("pressure gas has no potential")));
  const auto held = [&](const std::string& axes) {
    return scene(pressure + R"(, "constraints": {"rim": {"type": "pin", "body": "cloth", "axes": ")" + axes +
                 R"(", "select": {"boundary": true}}})");
  };
  EXPECT_THAT(build_model(held("xz"))->notes, testing::ElementsAre(HasSubstr("along y")));
  EXPECT_EQ(build_model(held("xyz"))->pressures.size(), 1u);
}

TEST_F(Build, PinsUniteAndMayNotDisagree) {
  const auto pins = [&](const std::string& second) {
    return scene(
        R"("constraints": {"a": {"type": "pin", "body": "cloth", "select": {"edges": ["x0"]}}, "b": {"type": "pin", "body": "cloth", )" +
        second + "}}");
  };
  EXPECT_EQ(build_model(pins(R"("select": {"edges": ["x0", "y0"]})"))->pins.size(), 3u * 7);
  EXPECT_EQ(build_model(pins(R"("select": {"edges": ["y0"]}, "motion": {"keyframes": [{"time": 0}]})"))->pins.size(),
            3u * 7)
      << "at rest as well";
  const std::string conflict = error(pins(R"("select": {"edges": ["y0"]}, "motion": {"velocity": [0, 0, 1]})"));
  EXPECT_THAT(conflict, testing::AllOf(HasSubstr("/constraints/b: "), HasSubstr("that of a"),
                                       HasSubstr("x of vertex 0 of cloth")));
}

TEST_F(Build, NamesWhatOnlyTheMeshTells) {
  const auto constrained = [&](const std::string& constraint) {
    return scene(R"("constraints": {"c": {"body": "cloth", )" + constraint + "}}");
  };
  EXPECT_THAT(error(constrained(R"("type": "pin", "select": {"vertices": [15]})")),
              testing::StartsWith("/constraints/c/select: "));
  EXPECT_THAT(error(constrained(R"("type": "strain_limit", "max": 1.1, "select": {"edges": ["x0"]})")),
              testing::AllOf(testing::StartsWith("/constraints/c/select: "), HasSubstr("no triangle")));
  EXPECT_THAT(
      error(constrained(R"("type": "sphere", "center": [0, 0, 0], "radius": 1, "select": {"group": "sleeve"})")),
      testing::AllOf(testing::StartsWith("/constraints/c/select: "), HasSubstr("sleeve")));
  const auto loaded = [&](const std::string& load) {
    return scene(R"("loads": {"l": {"body": "cloth", )" + load + "}}");
  };
  EXPECT_THAT(
      error(loaded(
          R"("type": "point_load", "force": [1, 0, 0], "select": {"box": {"min": [7, 7, 7], "max": [8, 8, 8]}})")),
      testing::StartsWith("/loads/l/select: "));
  EXPECT_THAT(error(loaded(R"("type": "edge_load", "force_per_length": [1, 0, 0], "select": {"vertices": [0, 14]})")),
              HasSubstr("no boundary edge"));

  write("thin.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_THAT(error(scene("", "", R"({"file": "thin.obj"})")),
              testing::AllOf(testing::StartsWith("/bodies/cloth/mesh: "), HasSubstr("zero area")));
  write("broken.obj", "v 0 0\n");
  EXPECT_THAT(error(scene("", "", R"({"file": "broken.obj"})")), HasSubstr("broken.obj:1"));
  write("tetrahedron.obj", tetrahedron);
  EXPECT_THAT(error(scene("", R"("rest": {"from": "uv"})", R"({"file": "tetrahedron.obj"})")),
              testing::AllOf(testing::StartsWith("/bodies/cloth/rest: "), HasSubstr("without uv")));
  EXPECT_THAT(error(scene("", R"("rest": {"from": "mesh", "file": "tetrahedron.obj"})")),
              testing::AllOf(testing::StartsWith("/bodies/cloth/rest: "), HasSubstr("same triangles")));
  write("folded.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvt 2 2\nf 1/1 2/2 3/3\n");
  EXPECT_THAT(error(scene("", R"("rest": {"from": "uv"})", R"({"file": "folded.obj"})")),
              HasSubstr("triangle 0 has no area in uv"));
}

}  // namespace
}  // namespace taut
