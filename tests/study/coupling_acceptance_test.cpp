#include <gtest/gtest.h>

#include "tests/study/coupling_study.h"

namespace taut {
namespace {

class Ratio : public testing::TestWithParam<int> {};

TEST_P(Ratio, OfCompressedSheetGivesTheSameInAllWays) {
  const CouplingStudy study("compressed_sheet", {{"bodies.plate.cover.mesh.refine", std::to_string(GetParam())}}, 10,
                            GetParam() < 3);
  EXPECT_EQ(study.unsolved, 0);
  EXPECT_LE(study.distance, 1e-8);
  EXPECT_LE(study.coupling, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Refinements, Ratio, testing::Values(1, 2, 3));

}  // namespace
}  // namespace taut
