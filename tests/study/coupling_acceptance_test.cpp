#include <gtest/gtest.h>

#include <ostream>

#include "tests/study/coupling_study.h"

namespace taut {
namespace {

struct Case {
  std::string problem, body;
  int levels, steps;
  std::vector<std::string> others;

  std::string name() const {
    std::string text = problem + "_level_" + std::to_string(levels);
    for (const std::string& other : others) text += "_" + other;
    return text;
  }
  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name() << ", " << c.steps << " steps"; }
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
                                         Case{"quilt", "quilt", 1, 20, {penalised, factorised, ipopt}},
                                         Case{"quilt", "quilt", 2, 20, {penalised, factorised}},
                                         Case{"quilt", "quilt", 3, 20, {penalised}},
                                         Case{"quilt", "quilt", 3, 17, {iterative}}),
                         [](const auto& instance) { return instance.param.name(); });

}  // namespace
}  // namespace taut
