#include <gtest/gtest.h>

#include "support/random_values.h"
#include "support/specimens.h"

namespace taut {
namespace {

class EveryConstraint : public testing::TestWithParam<ConstraintSpecimen> {};

TEST_P(EveryConstraint, HasJacobianAndContractedHessianAtTaylorSlopesTwoAndThree) {
  const auto constraint = GetParam().make();
  const Index rows = constraint->stencils().count() * constraint->rows();
  for (Pose pose : all_poses()) {
    if (GetParam().kinks.contains(pose)) continue;
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Contraction contraction(*constraint, RandomValues(seed).vector(rows));
      expect_derivatives(contraction, posed(pose), SemidefiniteForm::projection, to_string(pose));
    }
  }
}

TEST_P(EveryConstraint, ViolationIsZeroExactlyWhereTheSetHoldsTheValue) {
  const auto constraint = GetParam().make();
  Vector local(constraint->stencils().width()), c(constraint->rows()), nearest(constraint->rows());
  for (Pose pose : all_poses()) {
    const Vector x = posed(pose);
    for (Index element = 0; element < constraint->stencils().count(); ++element) {
      constraint->stencils().gather(element, x, local.data());
      constraint->evaluate(element, local.data(), c.data(), nullptr);
      constraint->set().project(element, c.data(), nearest.data(), nullptr);
      EXPECT_EQ(constraint->violation(element, local.data()) > 0, (nearest - c).norm() > 0)
          << to_string(pose) << " " << element;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(, EveryConstraint, testing::ValuesIn(constraint_specimens()),
                         [](const auto& specimen) { return specimen.param.name; });

}  // namespace
}  // namespace taut
