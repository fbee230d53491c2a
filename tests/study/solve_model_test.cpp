#include "study/solve_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "problems/nl_writer.h"
#include "problems/read_scene.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

namespace fs = std::filesystem;

ModelSolution solve(const std::string& name, const Overrides& overrides = {}) {
  const fs::path file = fs::path(TAUT_SOURCE_DIR) / "problems" / "nl" / (name + ".nl");
  const NlModel model(file);
  return solve_model(model, read_model_settings(file, overrides), {}, "test");
}

struct Known {
  std::string name;
  Status status;
  double objective = 0;  ///< where solved; make.py says where each comes from
};

void PrintTo(const Known& known, std::ostream* out) { *out << known.name; }

class KnownModel : public testing::TestWithParam<Known> {};

TEST_P(KnownModel, EndsAsItShould) {
  const ModelSolution solution = solve(GetParam().name);
  const RunSummary& s = solution.summary;
  EXPECT_EQ(s.status, GetParam().status) << s.message;
  if (GetParam().status != Status::solved) return;
  EXPECT_NEAR(s.objective, GetParam().objective, 1e-6 * std::max(std::abs(GetParam().objective), 1e-10));
  EXPECT_LE(s.feasibility.unscaled, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(
    , KnownModel,
    testing::Values(Known{"infeasible_rows", Status::infeasible}, Known{"infeasible_disc", Status::infeasible},
                    Known{"unbounded_line", Status::unbounded}, Known{"unbounded_free", Status::unbounded},
                    // No multipliers exist at its solution, so nothing can be called solved.
                    Known{"no_qualification", Status::stalled}, Known{"redundant_rows", Status::solved, 2},
                    Known{"scaled_up", Status::solved, 0}, Known{"scaled_down", Status::solved, 4.5674808719e-10},
                    Known{"fixed_variables", Status::solved, 8}, Known{"no_objective", Status::solved, 0},
                    Known{"range_rows", Status::solved, 5.5}, Known{"infeasible_start", Status::solved, 2}),
    [](const auto& known) { return known.param.name; });

TEST(SolveModel, SlsqpClaimsSuccessWhereThereIsNoPoint) {
  const ModelSolution ours = solve("infeasible_rows");
  const ModelSolution theirs = solve("infeasible_rows", {{"solver.method", "nlopt"}, {"solver.starts", "1"}});
  EXPECT_EQ(ours.summary.status, Status::infeasible);
  EXPECT_THAT(theirs.summary.message, testing::HasSubstr("NLopt says XTOL_REACHED, the residuals do not agree"));
  EXPECT_NE(theirs.summary.status, Status::solved);
  EXPECT_NEAR(ours.summary.feasibility.unscaled, 0.5, 1e-6) << "the closest compromise splits the gap";
  ASSERT_FALSE(ours.summary.worst_elements.empty());
  EXPECT_THAT(ours.summary.worst_elements[0].element, testing::HasSubstr("row"));
}

TEST(SolveModel, DualsAreTheRateOfTheObjectiveInTheRowsBound) {
  // min x0^2 + x1^2, x0 x1 >= b: f = 2 b. max x0 + 2 x1 with x0 - x1 >= a and x0 + x1 <= b: f = (3 b - a)/2.
  const ModelSolution smallest = solve("infeasible_start"), largest = solve("range_rows");
  EXPECT_NEAR(smallest.dual[0], 2, 1e-5);
  EXPECT_NEAR(largest.dual[0], -0.5, 1e-5);
  EXPECT_NEAR(largest.dual[1], 1.5, 1e-5);
}

TEST(SolveModel, NearTheSolutionNewtonStepsGoFarBelowTheTolerance) {
  for (const char* name : {"infeasible_start", "redundant_rows", "fixed_variables"}) {
    const Overrides loop{{"solver.starts", "1"}, {"solver.central_path", "false"}};
    Overrides without = loop;
    without.emplace_back("solver.newton_finish", "false");
    const RunSummary ours = solve(name, loop).summary, plain = solve(name, without).summary;
    EXPECT_EQ(ours.status, Status::solved) << name;
    EXPECT_LE(ours.stationarity.scaled, 1e-12) << name;
    EXPECT_LE(ours.feasibility.unscaled, 1e-12) << name;
    EXPECT_GT(std::max(plain.feasibility.unscaled, plain.stationarity.scaled), 1e-10) << name;
  }
}

TEST(SolveModel, NewtonStepsThatDoNotEndNearASolutionChangeNothing) {
  const Overrides loop{{"solver.starts", "1"}, {"solver.central_path", "false"}};
  Overrides without = loop;
  without.emplace_back("solver.newton_finish", "false");
  const ModelSolution tried = solve("no_qualification", loop), plain = solve("no_qualification", without);
  EXPECT_GT(tried.summary.counts.linear_solves, plain.summary.counts.linear_solves);
  EXPECT_EQ(tried.summary.status, Status::stalled);
  EXPECT_EQ(tried.x, plain.x);
  EXPECT_EQ(tried.dual, plain.dual);
}

/// Solves a model that a test has written.
ModelSolution solve_file(const fs::path& file, const Overrides& overrides = {}) {
  return solve_model(NlModel(file), read_model_settings(file, overrides), {}, "test");
}

class WideModel : public FilesTest {
 protected:
  /// min sum of 100 (x_{2i+1} - x_{2i}^2)^2 + (1 - x_{2i})^2 from (-1.2, 1): f = 0.
  fs::path extended_rosenbrock(int variables) const {
    NlFile file;
    file.start = Vector::Ones(variables);
    file.lower = Vector::Constant(variables, -HUGE_VAL);
    file.upper = Vector::Constant(variables, HUGE_VAL);
    std::vector<NlExpression> terms;
    for (int i = 0; i < variables; i += 2) {
      const NlExpression x = NlExpression::variable(i), y = NlExpression::variable(i + 1);
      file.start[i] = -1.2;
      terms.push_back(100 * square(y - square(x)));
      terms.push_back(square(1 - x));
    }
    for (int i = 0; i < variables; ++i) file.variable_names.push_back("x" + std::to_string(i));
    file.objective.nonlinear = sum(terms);
    file.write(path("wide.nl"));
    return path("wide.nl");
  }
};

class Infeasible : public FilesTest {};

TEST_F(Infeasible, VariantsOfOrdinaryProblemsAreCalledSoWhereSlsqpClaimsSuccess) {
  const NlExpression x = NlExpression::variable(0), y = NlExpression::variable(1);
  const NlExpression rosenbrock = 100 * square(y - square(x)) + square(1 - x), bowl = square(x) + square(y);
  const NlFile::Row at_least_3{"at least 3", {0, {{0, 1}, {1, 1}}}, 3, HUGE_VAL},
      at_most_2{"at most 2", {0, {{0, 1}, {1, 1}}}, -HUGE_VAL, 2}, disc{"disc", {bowl, {}}, -HUGE_VAL, 1},
      product{"product", {x * y, {}}, 1, HUGE_VAL};
  const std::vector<std::pair<NlExpression, std::vector<NlFile::Row>>> variants{{rosenbrock, {at_least_3, at_most_2}},
                                                                                {bowl, {at_least_3, at_most_2}},
                                                                                {rosenbrock, {disc, at_least_3}},
                                                                                {bowl, {product, disc}}};
  int claims = 0;
  for (const auto& [objective, rows] : variants) {
    NlFile file;
    file.start = Vector::Constant(2, 0.5);
    file.lower = Vector::Constant(2, -HUGE_VAL);
    file.upper = Vector::Constant(2, HUGE_VAL);
    file.variable_names = {"x", "y"};
    file.objective.nonlinear = objective;
    file.rows = rows;
    file.write(path("variant.nl"));
    const ModelSolution ours = solve_file(path("variant.nl")),
                        theirs = solve_file(path("variant.nl"), {{"solver.method", "nlopt"}, {"solver.starts", "1"}});
    EXPECT_EQ(ours.summary.status, Status::infeasible) << rows[0].name << ", " << rows[1].name;
    EXPECT_FALSE(ours.false_success);
    EXPECT_NE(theirs.summary.status, Status::solved);
    claims += theirs.false_success;
  }
  EXPECT_GE(claims, 1) << "round-off decides which: two in a release build, one under the sanitizers";
}

TEST_F(WideModel, MultipliersInTheModelAreTheFirstOnes) {
  // min x^2 + y^2 with 1000 (x + y) >= 4000: f = 8 at (2, 2), where the rate of f in the bound is 0.004.
  std::vector<long> systems;
  for (const double dual : {0.0, 0.004}) {
    const NlExpression x = NlExpression::variable(0), y = NlExpression::variable(1);
    NlFile file;
    file.start = Vector::Constant(2, 2);
    file.lower = Vector::Constant(2, -HUGE_VAL);
    file.upper = Vector::Constant(2, HUGE_VAL);
    file.variable_names = {"x", "y"};
    file.objective.nonlinear = square(x) + square(y);
    file.rows.push_back({"row", {0, {{0, 1000}, {1, 1000}}}, 4000, HUGE_VAL, dual});
    file.write(path("guess.nl"));
    const NlModel model(path("guess.nl"));
    EXPECT_EQ(model.start_dual()[0], dual);
    const ModelSolution solution =
        solve_file(path("guess.nl"), {{"solver.starts", "1"}, {"solver.central_path", "false"}});
    EXPECT_NEAR(solution.dual[0], 0.004, 1e-8);
    systems.push_back(solution.summary.counts.linear_solves);
  }
  EXPECT_EQ(systems[1], 0) << "from the solution and its multiplier";
  EXPECT_GT(systems[0], 0);
}

TEST_F(WideModel, TenThousandVariablesTakeTheLinearSystemsOfAHundred) {
  const ModelSolution few = solve_file(extended_rosenbrock(100), {{"solver.starts", "1"}});
  const ModelSolution many = solve_file(extended_rosenbrock(10000), {{"solver.starts", "1"}});
  EXPECT_EQ(many.summary.status, Status::solved) << many.summary.message;
  EXPECT_LE((many.x - Vector::Ones(10000)).lpNorm<Eigen::Infinity>(), 1e-6);
  EXPECT_EQ(many.summary.counts.linear_solves, few.summary.counts.linear_solves);
  const ModelSolution by_default = solve_file(extended_rosenbrock(10000), {});
  EXPECT_EQ(by_default.summary.counts.linear_solves, many.summary.counts.linear_solves) << "no other starts";
}

TEST_F(WideModel, AStringOverAnObstacleIsStraightOnBothSides) {
  // min sum of (u_{i+1} - u_i)^2/2 with u = 0 at both ends, at least 1 in the middle, at least -1 elsewhere, and at
  // most 5 in the left half.
  constexpr int intervals = 400, middle = intervals / 2;
  NlFile file;
  file.start = Vector::Zero(intervals + 1);
  file.lower = Vector::Constant(intervals + 1, -1);
  file.upper = Vector::Constant(intervals + 1, HUGE_VAL);
  file.upper.head(middle).setConstant(5);
  file.lower[middle] = 1;
  file.lower[0] = file.upper[0] = file.lower[intervals] = file.upper[intervals] = 0;
  std::vector<NlExpression> terms;
  for (int i = 0; i < intervals; ++i)
    terms.push_back(0.5 * square(NlExpression::variable(i + 1) - NlExpression::variable(i)));
  for (int i = 0; i <= intervals; ++i) file.variable_names.push_back("u" + std::to_string(i));
  file.objective.nonlinear = sum(terms);
  file.write(path("string.nl"));
  const ModelSolution solution =
      solve_file(path("string.nl"), {{"solver.starts", "1"}, {"solver.tolerance.stationarity", "1e-9"}});
  EXPECT_EQ(solution.summary.status, Status::solved) << solution.summary.message;
  EXPECT_NEAR(solution.summary.objective, 2.0 / intervals, 1e-6 * 2.0 / intervals);
  for (int i = 0; i <= intervals; ++i)
    EXPECT_NEAR(solution.x[i], std::min(i, intervals - i) / static_cast<double>(middle), 1e-5) << i;
}

TEST(SolveModel, FixedVariablesAreNamedAsWhatTheyAre) {
  const RunSummary summary = solve("fixed_variables").summary;
  ASSERT_FALSE(summary.violations.empty());
  EXPECT_EQ(summary.violations.back().constraint, "fixed variables");
}

TEST(SolveModel, OtherSolversAgree) {
  for (const char* method : {"ipopt", "nlopt", "null_space"}) {
#ifndef TAUT_WITH_IPOPT
    if (std::string(method) == "ipopt") continue;
#endif
    const ModelSolution solution = solve("infeasible_start", {{"solver.method", method}});
    EXPECT_EQ(solution.summary.status, Status::solved) << method;
    EXPECT_NEAR(solution.summary.objective, 2, 2e-6) << method;
  }
}

TEST(SolveModel, StopsWhereItIsTold) {
  const std::atomic<bool> stop = true;
  Budget budget;
  budget.stop = &stop;
  const fs::path file = fs::path(TAUT_SOURCE_DIR) / "problems" / "nl" / "scaled_up.nl";
  const NlModel model(file);
  EXPECT_EQ(solve_model(model, read_model_settings(file), budget, "test").summary.status, Status::interrupted);
}

}  // namespace
}  // namespace taut
