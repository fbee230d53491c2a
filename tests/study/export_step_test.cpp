#include "study/export_step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "problems/build.h"
#include "problems/nl_model.h"
#include "problems/read_scene.h"
#include "study/examine.h"
#include "study/solve_model.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using testing::HasSubstr;

const Overrides tight{{"solver.tolerance.stationarity", "1e-9"},
                      {"solver.tolerance.feasibility", "1e-9"},
                      {"solver.tolerance.complementarity", "1e-9"}};

Overrides operator+(Overrides a, const Overrides& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::string catalogue(const std::string& name) { return std::string(TAUT_CATALOGUE) + "/" + name + ".json"; }

class ExportStep : public FilesTest {
 protected:
  /// Solves the steps before `step`, exports that one, solves it both ways and compares. Returns the multipliers of the
  /// largest norm, of each constraint and then of each system of equalities.
  std::vector<double> expect_same_optimum(const Scene& scene, int step) {
    const auto model = build_model(scene);
    Stepper stepper(*model, time_options(scene));
    const auto solver = build_solver(scene, 1);
    for (int k = 1; k < step; ++k) {
      const Result result = solver->solve(stepper.prepare(), stepper.state().warm, {});
      EXPECT_EQ(result.status, Status::solved) << "step " << k << ": " << result.message;
      stepper.accept(result);
    }
    export_step(scene, *model, stepper).write(path("step.nl"));
    const Problem& problem = stepper.prepare();
    const Result native = solver->solve(problem, stepper.state().warm, {});
    EXPECT_EQ(native.status, Status::solved) << native.message;
    const double optimum = objective(problem, native.x);

    const NlModel read(path("step.nl"));
    EXPECT_EQ(read.variables(), problem.size());
    EXPECT_EQ(read.start(), problem.initial_guess);
    for (const std::string method : {"augmented_lagrangian", "ipopt"}) {
#ifndef TAUT_WITH_IPOPT
      if (method == "ipopt") continue;
#endif
      const Scene settings =
          read_model_settings(path("step.nl"), tight + Overrides{{"solver.tolerance.feasibility", "1e-12"},
                                                                 {"solver.method", method},
                                                                 {"solver.starts", "1"}});
      const ModelSolution solution = solve_model(read, settings, {}, "test");
      EXPECT_EQ(solution.summary.status, Status::solved) << method << ": " << solution.summary.message;
      EXPECT_NEAR(solution.summary.objective, optimum, 1e-8 * std::abs(optimum)) << method;
      EXPECT_LE((solution.x - native.x).lpNorm<Eigen::Infinity>(), 1e-6) << method;
    }
    std::vector<double> largest;
    for (const Vector& multipliers : native.multipliers) largest.push_back(multipliers.lpNorm<Eigen::Infinity>());
    return largest;
  }
  std::string refusal(const Scene& scene) {
    const auto model = build_model(scene);
    Stepper stepper(*model, time_options(scene));
    try {
      export_step(scene, *model, stepper);
    } catch (const InputError& error) {
      return error.what();
    }
    return "exported";
  }
};

TEST_F(ExportStep, HangingClothHasTheSameOptimumOnceReadBack) {
  expect_same_optimum(
      read_scene(catalogue("hanging_cloth"), tight + Overrides{{"bodies.cloth.mesh.grid.cells", "[6, 6]"}}), 15);
}

TEST_F(ExportStep, ClothOnASphere) {
  expect_same_optimum(
      read_scene(catalogue("table_cloth"), tight + Overrides{{"bodies.cloth.mesh.grid.cells", "[6, 6]"}}), 12);
}

TEST_F(ExportStep, CoverOnItsShell) {
  std::ofstream(path("cover.json")) << R"({
    "format": 1,
    "time": { "integrator": "implicit_euler", "step": 0.01, "steps": 5 },
    "gravity": [0, 0, -9.81],
    "bodies": { "sheet": {
      "model": "wrinkled_shell", "mesh": { "grid": { "size": [0.4, 0.4], "cells": [2, 2] } },
      "thickness": 0.001, "density": 300,
      "membrane": { "law": "stvk", "young_modulus": 2e4, "poisson_ratio": 0.3 }, "bending": { "stiffness": 1e-05 },
      "cover": {
        "mesh": { "refine": 1 }, "thickness": 0.0003, "density": 470,
        "membrane": { "law": "stvk", "young_modulus": 2e5, "poisson_ratio": 0.3 }, "bending": { "stiffness": 2e-06 },
        "imperfection": { "amplitude": 2e-4, "seed": 1 } } } },
    "constraints": {
      "held": { "type": "pin", "body": "sheet", "select": { "corners": ["x0y0", "x1y1"] } },
      "floor": { "type": "half_space", "body": "sheet", "point": [0, 0, -0.002], "normal": [0, 0, 1] },
      "limit": { "type": "strain_limit", "body": "sheet/cover", "max": 1.02 } }
  })";
  // The weight on the floor, 1 N, times a violation of 1e-9 m would show in the objective.
  expect_same_optimum(read_scene(path("cover.json"), tight + Overrides{{"solver.tolerance.feasibility", "1e-12"}}), 3);
}

TEST_F(ExportStep, CoverAtItsStrainLimit) {
  std::ofstream(path("stretched.json")) << R"({
    "format": 1,
    "time": { "integrator": "implicit_euler", "step": 0.01, "steps": 12 },
    "gravity": [0, 0, -9.81],
    "bodies": { "sheet": {
      "model": "wrinkled_shell", "mesh": { "grid": { "size": [0.4, 0.4], "cells": [2, 2] } },
      "thickness": 0.001, "density": 300,
      "membrane": { "law": "stvk", "young_modulus": 2e3, "poisson_ratio": 0.3 }, "bending": { "stiffness": 1e-05 },
      "cover": {
        "mesh": { "refine": 1 }, "thickness": 0.0003, "density": 470,
        "membrane": { "law": "stvk", "young_modulus": 2e3, "poisson_ratio": 0.3 }, "bending": { "stiffness": 2e-06 },
        "imperfection": { "amplitude": 2e-4, "seed": 1 } } } },
    "constraints": {
      "held": { "type": "pin", "body": "sheet", "select": { "corners": ["x0y0", "x1y1"] } },
      "limit": { "type": "strain_limit", "body": "sheet/cover", "max": 1.01 } }
  })";
  const std::vector<double> multipliers = expect_same_optimum(
      read_scene(path("stretched.json"), tight + Overrides{{"solver.tolerance.feasibility", "1e-12"}}), 12);
  ASSERT_EQ(multipliers.size(), 2u);
  EXPECT_GT(multipliers[0], 0.1) << "the limit is active, N/m";
  EXPECT_GT(multipliers[1], 0.1) << "the cover pulls at its shell, N";
}

TEST_F(ExportStep, RefusesByNameWhatItCannotWrite) {
  EXPECT_THAT(refusal(read_scene(catalogue("quilt"))), HasSubstr("found"));
  EXPECT_THAT(refusal(read_scene(catalogue("pillow"))), HasSubstr("found air in the step to export"));
  EXPECT_THAT(refusal(read_scene(catalogue("hanging_cloth"), {{"bodies.cloth.membrane.law", "neo_hookean"}})),
              HasSubstr("found membrane of cloth"));
  EXPECT_THAT(refusal(read_scene(catalogue("hanging_cloth"), {{"constraints.limit.form", "singular_values"}})),
              HasSubstr("found limit"));
}

TEST_F(ExportStep, NamesVariablesAndRows) {
  const Scene scene = read_scene(catalogue("hanging_cloth"), {{"bodies.cloth.mesh.grid.cells", "[2, 2]"}});
  const auto model = build_model(scene);
  Stepper stepper(*model, time_options(scene));
  export_step(scene, *model, stepper).write(path("step.nl"));
  const NlModel read(path("step.nl"));
  EXPECT_EQ(read.variable_name(5), "vertex 1 of cloth, z");
  EXPECT_EQ(read.row_name(1), "limit: triangle 0 of cloth, upper determinant");
  EXPECT_EQ(read.rows(), 8 * 4);
}

}  // namespace
}  // namespace taut
