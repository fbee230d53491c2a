#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solvers/curvature.h"
#include "tests/study/coupling_study.h"

namespace taut {
namespace {

const std::vector<std::string> direct{"penalised_equalities", "null_space"};
const std::vector<std::string> all{"penalised_equalities", "null_space", "null_space_cg", "ipopt"};

void expect_agreement(const CouplingStudy& study) {
  EXPECT_EQ(study.unsolved, 0);
  EXPECT_LE(study.distance, 1e-8);
  EXPECT_LE(study.coupling, 1e-10);
}

TEST(CoupledSolvers, AgreeOnACompressedSheetAtRatioTwo) {
  // The fourth step is the one in which the film buckles.
  expect_agreement(CouplingStudy("compressed_sheet", {{"bodies.plate.cover.mesh.refine", "1"}}, 5, all));
}

TEST(CoupledSolvers, AgreeOnAQuiltWithAStrainLimitAtRatioTwo) {
  expect_agreement(CouplingStudy("quilt", {{"bodies.quilt.cover.mesh.refine", "1"}}, 2, all));
}

TEST(CoupledSolvers, AgreeWithEveryIntegrator) {
  for (const char* integrator : {"bdf2", "generalised_alpha"}) {
    SCOPED_TRACE(integrator);
    expect_agreement(
        CouplingStudy("quilt", {{"bodies.quilt.cover.mesh.refine", "1"}, {"time.integrator", integrator}}, 3, direct));
  }
}

TEST(CoupledSolvers, AgreeOnAMatWhoseEndsAreTurned) {
  expect_agreement(CouplingStudy("yoga_mat", {{"bodies.mat.cover.mesh.refine", "1"}}, 3, all));
}

TEST(CoupledSolvers, AgreeWhereTheFilmIsPinnedToo) {
  expect_agreement(CouplingStudy("stretched_sheet", {{"bodies.sheet.cover.mesh.refine", "1"}}, 2, all));
}

/// A quilt of 4 x 4 cells whose cover, with a strain limit, lies on a floor, on a ball, or on both.
Overrides quilt_on(const std::string& integrator, bool floor, bool ball) {
  Overrides overrides{{"bodies.quilt.mesh.grid.cells", "[4, 4]"},
                      {"bodies.quilt.cover.mesh.refine", "1"},
                      {"bodies.quilt.cover.surface", "bottom"},
                      {"time.integrator", integrator},
                      {"constraints.limit.max", "1.002"}};
  if (floor)
    overrides.emplace_back("constraints.floor", R"({"type": "half_space", "body": "quilt/cover",
        "point": [0, 0, -0.02], "normal": [0.05, 0, 1]})");
  if (ball)
    overrides.emplace_back("constraints.ball", R"({"type": "sphere", "body": "quilt/cover",
        "center": [0.5, 0.55, -0.415], "radius": 0.4})");
  return overrides;
}

class CoveredObstacles : public testing::TestWithParam<const char*> {};

TEST_P(CoveredObstacles, AreMetInTheSamePlaceInAllWays) {
  for (const auto& [floor, ball] : {std::pair{true, false}, {false, true}, {true, true}}) {
    SCOPED_TRACE(testing::Message() << "floor " << floor << ", ball " << ball);
    const CouplingStudy study("quilt", quilt_on(GetParam(), floor, ball), 5, direct);
    expect_agreement(study);
    EXPECT_GE(study.active_steps, 3);
  }
}

INSTANTIATE_TEST_SUITE_P(Integrators, CoveredObstacles, testing::Values("implicit_euler", "bdf2", "generalised_alpha"),
                         [](const auto& instance) { return std::string(instance.param); });

TEST(StaticCoverOnAFloor, HasSeveralStrictMinima) {
  Overrides overrides = quilt_on("static", true, false);
  for (const char* residual : {"stationarity", "feasibility", "complementarity"})
    overrides.emplace_back(std::string("solver.tolerance.") + residual, "1e-9");
  const Scene scene = read_scene(TAUT_CATALOGUE "/quilt.json", overrides);
  const auto model = build_model(scene);
  const auto solver = build_solver(scene, 1);
  Stepper stepper(*model, time_options(scene));
  Problem problem = stepper.prepare();
  const Vector flat = problem.initial_guess;
  std::vector<Result> ends;
  for (const double bump : {0.02, -0.02}) {
    SCOPED_TRACE(bump);
    for (Index i = 2; i < flat.size(); i += 3)
      problem.initial_guess[i] = flat[i] + bump * std::sin(7 * flat[i - 2]) * std::sin(7 * flat[i - 1]);
    ends.push_back(solver->solve(problem, {}, {}));
    const Result& end = ends.back();
    EXPECT_TRUE(residuals(problem, end).within(scene.solver.tolerance)) << end.message;
    EXPECT_EQ(negative_curvatures(problem, end, end.penalties), 0);
    // Without multipliers from there, nothing leads away.
    problem.initial_guess = end.x;
    EXPECT_LE((solver->solve(problem, {}, {}).x - end.x).lpNorm<Eigen::Infinity>(), 1e-8);
  }
  EXPECT_GE((ends[1].x - ends[0].x).lpNorm<Eigen::Infinity>(), 1e-3);
}

TEST(CompressedSheet, BucklesInFewNewtonSteps) {
  const Scene scene = read_scene(TAUT_CATALOGUE "/compressed_sheet.json");
  const auto model = build_model(scene);
  const auto solver = build_solver(scene, 1);
  Stepper stepper(*model, time_options(scene));
  long most = 0;
  for (int step = 0; step < 3; ++step) {
    const Problem& problem = stepper.prepare();
    const Result result = solver->solve(problem, stepper.state().warm, {});
    EXPECT_EQ(result.status, Status::solved) << result.message;
    most = std::max(most, result.counts.linear_solves);
    stepper.accept(result);
  }
  EXPECT_LE(most, 20);  // 38 where semidefinite Hessians take over from an indefinite one
}

TEST(AlternatingSides, EndWhereTheDefaultDoes) {
  // Each half is solved to 0.3 of the tolerance; what is left in the positions follows from the softest of them.
  const CouplingStudy quilt("quilt", {{"bodies.quilt.cover.mesh.refine", "1"}}, 3, {"alternating"}, "1e-8");
  EXPECT_EQ(quilt.unsolved, 0);
  EXPECT_LE(quilt.distance, 1e-7);
  const CouplingStudy sheet("compressed_sheet", {{"bodies.plate.cover.mesh.refine", "1"}}, 2, {"alternating"}, "1e-8");
  EXPECT_EQ(sheet.unsolved, 0);
  EXPECT_LE(sheet.distance, 1e-7);
}

TEST(AlternatingSides, AreRefusedWhereThereIsNoCover) {
  const Scene scene = read_scene(TAUT_CATALOGUE "/hanging_cloth.json", {{"solver.method", "alternating"}});
  EXPECT_THROW(build_solver(scene, 1), InputError);
}

}  // namespace
}  // namespace taut
