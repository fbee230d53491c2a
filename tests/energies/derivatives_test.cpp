#include <gtest/gtest.h>

#include "support/specimens.h"

namespace taut {
namespace {

class EveryEnergy : public testing::TestWithParam<EnergySpecimen> {};

TEST_P(EveryEnergy, HasTaylorSlopesTwoAndThreeInEveryPose) {
  const auto energy = GetParam().make();
  for (Pose pose : all_poses()) expect_derivatives(*energy, GetParam().posed(pose), GetParam().form, to_string(pose));
}

TEST_P(EveryEnergy, GivesTheSameValueWithAndWithoutDerivatives) {
  const auto energy = GetParam().make();
  const Index width = energy->stencils().width();
  const Vector x = GetParam().posed(Pose::stretched);
  Vector local(width), gradient(width), gradient_alone(width);
  Matrix hessian(width, width);
  for (Index element = 0; element < energy->stencils().count(); ++element) {
    energy->stencils().gather(element, x, local.data());
    const double value = energy->evaluate(element, local.data(), nullptr, nullptr, Curvature::exact);
    EXPECT_EQ(value, energy->evaluate(element, local.data(), gradient_alone.data(), nullptr, Curvature::exact));
    EXPECT_EQ(value, energy->evaluate(element, local.data(), gradient.data(), hessian.data(),
                                      Curvature::positive_semidefinite));
    EXPECT_EQ(gradient, gradient_alone);
  }
}

TEST_P(EveryEnergy, WithoutCurvatureHasAZeroHessian) {
  const auto energy = GetParam().make();
  const Index width = energy->stencils().width();
  Vector local(width), gradient(width);
  Matrix hessian = Matrix::Ones(width, width);
  energy->stencils().gather(0, GetParam().posed(Pose::stretched), local.data());
  energy->evaluate(0, local.data(), gradient.data(), hessian.data(), Curvature::exact);
  EXPECT_EQ(hessian.isZero(0), !energy->has_curvature());
}

INSTANTIATE_TEST_SUITE_P(, EveryEnergy, testing::ValuesIn(energy_specimens()),
                         [](const auto& specimen) { return specimen.param.name; });

/// An energy whose Hessian is wrong by a part in a thousand in one entry: what the check is for.
class Wrong final : public Energy {
 public:
  explicit Wrong(std::shared_ptr<const Energy> energy) : energy_(std::move(energy)) {}
  std::string name() const override { return "wrong"; }
  const Stencils& stencils() const override { return energy_->stencils(); }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override {
    const double value = energy_->evaluate(element, x, gradient, hessian, curvature);
    if (hessian) hessian[0] *= 1.001;
    return value;
  }

 private:
  std::shared_ptr<const Energy> energy_;
};

TEST(DerivativeCheck, SeesAnErrorOfAThousandthInOneEntry) {
  for (const EnergySpecimen& specimen : energy_specimens()) {
    const Wrong wrong(specimen.make());
    Vector local(wrong.stencils().width());
    wrong.stencils().gather(0, specimen.posed(Pose::stretched), local.data());
    const DerivativeReport report = check_derivatives(wrong, 0, local, 1);
    if (specimen.name == "dead_load" || specimen.name == "pressure") continue;  // the entry is zero
    EXPECT_FALSE(report.second.at_least(2.9) && report.gradient.at_least(1.9)) << specimen.name;
  }
}

}  // namespace
}  // namespace taut
