#include "linalg/isotropic_hessian.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "support/derivative_check.h"
#include "support/random_values.h"

namespace taut {
namespace {

/// psi = a/2 (d1 - 1)^2 + a/2 (d2 - 1)^2 + b d1 d2, whose flip, twist and out-of-plane modes take both signs.
class SpringDensity final : public Energy {
 public:
  SpringDensity(double a, double b, const TriangleShape& shape) : a_(a), b_(b), shape_(shape) {
    stencils_.add_vertices(std::array{0, 1, 2});
  }
  std::string name() const override { return "spring"; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index /*element*/, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override {
    const Svd32 s = svd(Eigen::Map<const Matrix3>(x) * shape_);
    const double p1 = a_ * (s.d1 - 1) + b_ * s.d2, p2 = a_ * (s.d2 - 1) + b_ * s.d1;
    if (gradient) isotropic_gradient(s, shape_, p1, p2, weight, gradient);
    if (hessian) {
      const IsotropicDerivatives d{p1, p2, a_, b_, a_, a_ - b_, (p1 + p2) / (s.d1 + s.d2), p1 / s.d1, p2 / s.d2};
      isotropic_hessian(s, shape_, d, weight, curvature, hessian);
    }
    return weight * (0.5 * a_ * (std::pow(s.d1 - 1, 2) + std::pow(s.d2 - 1, 2)) + b_ * s.d1 * s.d2);
  }

 private:
  static constexpr double weight = 0.6;
  double a_, b_;
  TriangleShape shape_;
  Stencils stencils_{9};
};

TEST(IsotropicHessian, HasTaylorSlopesAndIsAProjectionForModesOfBothSigns) {
  RandomValues random(3);
  TriangleShape a;
  a << -1, -1, 1, 0, 0, 1;
  for (int sample = 0; sample < 30; ++sample) {
    const TriangleShape shape = a * (Matrix2::Identity() + 0.3 * Matrix2(random.matrix(2, 2)));
    const Matrix3 turn = random.rotation();
    const double low = random.between(0.5, 0.9), high = random.between(1.0, 1.5);
    Vector x(9);
    x << Vector3::Zero(), turn.col(0) * high, turn.col(1) * low + 0.1 * turn.col(0);
    for (double b : {0.0, 0.4, -3.0, 3.0}) {
      expect_derivatives(SpringDensity(1.0, b, shape), x, SemidefiniteForm::projection, "b = " + std::to_string(b));
    }
  }
}

}  // namespace
}  // namespace taut
