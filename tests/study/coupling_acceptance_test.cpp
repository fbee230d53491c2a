#include <gtest/gtest.h>

#include "tests/study/coupling_study.h"

namespace taut {
namespace {

struct Case {
  const char *problem, *body;
  int levels, steps;
  bool with_ipopt;
};

class Refined : public testing::TestWithParam<Case> {};

TEST_P(Refined, GivesTheSameInAllWays) {
  const Case& c = GetParam();
  const std::string key = std::string("bodies.") + c.body + ".cover.mesh.refine";
  const CouplingStudy study(c.problem, {{key, std::to_string(c.levels)}}, c.steps, c.with_ipopt);
  EXPECT_EQ(study.unsolved, 0);
  EXPECT_LE(study.distance, 1e-8);
  EXPECT_LE(study.coupling, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Problems, Refined,
                         testing::Values(Case{"compressed_sheet", "plate", 1, 10, false},
                                         Case{"compressed_sheet", "plate", 2, 10, true},
                                         Case{"compressed_sheet", "plate", 3, 1, false},
                                         Case{"quilt", "quilt", 1, 7, true}, Case{"quilt", "quilt", 2, 4, true}),
                         [](const auto& instance) {
                           return std::string(instance.param.problem) + "_level_" +
                                  std::to_string(instance.param.levels);
                         });

}  // namespace
}  // namespace taut
