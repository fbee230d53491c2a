#include "study/solve_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "problems/read_scene.h"

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
