#include <gtest/gtest.h>

#include "tests/study/coupling_study.h"

namespace taut {
namespace {

struct Case {
  std::string problem, body;
  int levels, steps;
  std::vector<std::string> others;
};

class Refined : public testing::TestWithParam<Case> {};

TEST_P(Refined, GivesTheSameInAllWays) {
  const Case& c = GetParam();
  const std::string key = "bodies." + c.body + ".cover.mesh.refine";
  const CouplingStudy study(c.problem, {{key, std::to_string(c.levels)}}, c.steps, c.others);
  EXPECT_EQ(study.unsolved, 0);
  EXPECT_LE(study.distance, 1e-8);
  EXPECT_LE(study.coupling, 1e-10);
}

const std::string penalised = "penalised_equalities", factorised = "null_space", iterative = "null_space_cg",
                  ipopt = "ipopt";

INSTANTIATE_TEST_SUITE_P(Problems, Refined,
                         testing::Values(Case{"compressed_sheet", "plate", 1, 10, {penalised, factorised, ipopt}},
                                         Case{"compressed_sheet", "plate", 2, 10, {penalised, factorised, ipopt}},
                                         Case{"compressed_sheet", "plate", 3, 10, {penalised, iterative, ipopt}},
                                         Case{"quilt", "quilt", 2, 17, {penalised, factorised}},
                                         Case{"quilt", "quilt", 3, 20, {penalised}},
                                         Case{"quilt", "quilt", 3, 8, {iterative}}),
                         [](const auto& instance) {
                           const Case& c = instance.param;
                           std::string name = c.problem + "_level_" + std::to_string(c.levels);
                           for (const std::string& other : c.others) name += "_" + other;
                           return name;
                         });

TEST(QuiltAtRatioTwo, GivesTheSameInAllWays) {
  const Overrides quilt{{"bodies.quilt.cover.mesh.refine", "1"}};
  const CouplingStudy most("quilt", quilt, 17, {penalised, factorised, ipopt});
  EXPECT_LE(most.worst, 5e-9);  // in one step Ipopt stalls at 3e-9
  EXPECT_LE(most.distance, 1e-8);
  EXPECT_LE(most.coupling, 1e-10);
  // Then the strain limit is all but infeasible: its multipliers grow until round-off of the forces keeps every solver,
  // Ipopt too, from residuals below some 1e-9, and positions are that much less certain.
  const CouplingStudy whole("quilt", quilt, 20, {penalised, factorised});
  EXPECT_LE(whole.worst, 1e-7);
  EXPECT_LE(whole.distance, 2e-7);
  EXPECT_LE(whole.coupling, 1e-10);
}

}  // namespace
}  // namespace taut
