#include <gtest/gtest.h>

#include "tests/study/coupling_study.h"

namespace taut {
namespace {

void expect_agreement(const CouplingStudy& study) {
  EXPECT_EQ(study.unsolved, 0);
  EXPECT_LE(study.distance, 1e-8);
  EXPECT_LE(study.coupling, 1e-10);
}

TEST(CoupledSolvers, AgreeOnACompressedSheetAtRatioTwo) {
  const Overrides ratio{{"bodies.plate.cover.mesh.refine", "1"}};
  expect_agreement(CouplingStudy("compressed_sheet", ratio, 3, true));
  // The fourth step is the one in which the film buckles; here Ipopt ends in another pattern.
  expect_agreement(CouplingStudy("compressed_sheet", ratio, 5, false));
}

TEST(CoupledSolvers, AgreeOnAQuiltWithAStrainLimitAtRatioTwo) {
  expect_agreement(CouplingStudy("quilt", {{"bodies.quilt.cover.mesh.refine", "1"}}, 2, true));
}

TEST(CoupledSolvers, AgreeWithEveryIntegrator) {
  for (const char* integrator : {"bdf2", "generalised_alpha"}) {
    SCOPED_TRACE(integrator);
    expect_agreement(
        CouplingStudy("quilt", {{"bodies.quilt.cover.mesh.refine", "1"}, {"time.integrator", integrator}}, 3, false));
  }
}

TEST(CoupledSolvers, AgreeOnAMatWhoseEndsAreTurned) {
  expect_agreement(CouplingStudy("yoga_mat", {{"bodies.mat.cover.mesh.refine", "1"}}, 3, true));
}

TEST(CoupledSolvers, AgreeWhereTheFilmIsPinnedToo) {
  expect_agreement(CouplingStudy("stretched_sheet", {{"bodies.sheet.cover.mesh.refine", "1"}}, 2, true));
}

}  // namespace
}  // namespace taut
