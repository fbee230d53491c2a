#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <ostream>

#include "tests/study/cross_check.h"

namespace taut {
namespace {

struct Case {
  std::string name, problem;
  Overrides overrides;
  int steps;
  int two_minima = 0;  ///< steps in which the methods end in different minima, both confirmed by the judge
};

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

class EveryStep : public testing::TestWithParam<Case> {};

TEST_P(EveryStep, HasOneSolutionForThreeMethods) {
  const CrossCheck check(GetParam().problem, GetParam().overrides, GetParam().steps);
  ASSERT_EQ(check.steps(), GetParam().steps);
  for (const EntryRun& run : check.runs()) {
    // All are asked for 1e-9; with tight limits some end a little above, which the distances do not show.
    const EntrySummary summary = summarize(run);
    std::cout << GetParam().name << ", " << run.label << ": apart by " << summary.objective_distance
              << " in objective, " << summary.position_distance << " in positions; residual " << summary.residual
              << std::endl;
    EXPECT_EQ(summary.false_successes, 0) << run.label;
    int apart = 0;
    for (const StepTrial& trial : run.trials) {
      ASSERT_TRUE(trial.distance) << run.label << ", step " << trial.step;
      if (trial.distance->objective <= 1e-8 && trial.distance->positions <= 1e-6) continue;
      const Residuals& judged = trial.residuals;
      const double worst = std::max({judged.stationarity, judged.feasibility, judged.complementarity});
      std::cout << "  step " << trial.step << ": " << trial.distance->objective << ", " << trial.distance->positions
                << "; residual " << worst << ", " << trial.result.message << std::endl;
      ++apart;
    }
    EXPECT_LE(apart, GetParam().two_minima) << run.label;
    // Where Ipopt's rows have no multipliers its positions may be right, and their residual is not.
    if (run.label != "ipopt") {
      EXPECT_LE(summary.residual, 1e-6) << run.label;
    }
  }
}

std::vector<Case> cases() {
  std::vector<Case> all{{"stretched_strip", "stretched_strip", {}, 10},
                        {"sheet_on_sphere", "sheet_on_sphere", {}, 100, 2},
                        {"tight_limits", "tight_limits", {}, 100}};
  const struct {
    const char *name, *min, *max;
  } limits[] = {{"both_10", "0.9", "1.1"},
                {"upper_10", "0", "1.1"},
                {"upper_1", "0", "1.01"},
                {"upper_0_1", "0", "1.001"},
                {"both_1", "0.99", "1.01"}};
  for (int grid = 0; grid < 3; ++grid) {
    const std::string cells = std::to_string(8 + 4 * grid);
    for (const auto& limit : limits) {
      all.push_back({"cloth_" + cells + "_" + limit.name,
                     "hanging_cloth",
                     {{"bodies.cloth.mesh.grid.cells", "[" + cells + ", " + cells + "]"},
                      {"constraints.limit.min", limit.min},
                      {"constraints.limit.max", limit.max}},
                     100});
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(, EveryStep, testing::ValuesIn(cases()), [](const auto& c) { return c.param.name; });

}  // namespace
}  // namespace taut
