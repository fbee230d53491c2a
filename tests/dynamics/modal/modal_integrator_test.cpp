#include "dynamics/modal/modal_integrator.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>

#include "support/small_basis.h"

namespace taut {
namespace {

/// Two modes that both move the one node along x, without warping: a body held by one coordinate.
std::shared_ptr<ModalBasis> linear_pair() {
  auto basis = std::make_shared<ModalBasis>();
  basis->rest = Vector::Zero(3);
  basis->shapes = Matrix::Zero(3, 2);
  basis->shapes.row(0) << 1, 0.5;
  basis->rotations = Matrix::Zero(3, 2);
  basis->eigenvalues = Vector::Zero(2);
  basis->eigenvalues << 4, 25;
  basis->residuals = Vector::Zero(2);
  return basis;
}

/// Forces of the hand that pulls the node to x = 0.9 in nine steps and keeps it there. (From rest the velocity of the
/// average acceleration is twice the hand's after odd steps and none after even ones: an even number leaves no growth.)
std::vector<double> forces_after_a_jump(const NewmarkRule& rule, int steps) {
  const auto basis = linear_pair();
  ModalIntegrator body(basis, rule, Vector::Constant(2, 0.5), {{0, 0}});
  std::vector<double> forces;
  for (int k = 1; k <= steps; ++k) {
    body.step(Vector::Zero(2), Vector::Constant(1, std::min(0.9, k * 0.1)));
    forces.push_back(body.forces()[0]);
  }
  return forces;
}

/// The part that changes its sign from step to step: a fourth difference, in which what is smooth vanishes.
double saw_tooth(const std::vector<double>& f, std::size_t k) {
  return std::abs(f[k] - 4 * f[k - 1] + 6 * f[k - 2] - 4 * f[k - 3] + f[k - 4]) / 16;
}

/// Constrained, the average acceleration has the amplification [[-1, 0], [-4/h, -1]].
TEST(ModalIntegrator, UnderTheAverageAccelerationMultipliersSawToothAndGrowLinearly) {
  const auto forces = forces_after_a_jump({0.01, 0.25, 0.5}, 2000);
  const double early = saw_tooth(forces, 200), middle = saw_tooth(forces, 1100), late = saw_tooth(forces, 1999);
  EXPECT_GT(early, 100 * 3.5);  // beside a static force of about 3.5
  EXPECT_NEAR((late - middle) / 899, (middle - early) / 900, 0.02 * (middle - early) / 900);
  EXPECT_GT(late, early);
  for (std::size_t k = 1900; k < 1999; ++k) EXPECT_LT(forces[k] * forces[k + 1], 0) << k;
}

TEST(ModalIntegrator, UnderTheDefaultTheyDecayToTheStaticForce) {
  const auto forces = forces_after_a_jump({0.01, 0.3025, 0.6}, 8000);
  EXPECT_LT(saw_tooth(forces, 200), 1e-6);
  // 0.9 = f (1/4 + 1/4/25) in the static end; what is left of the vibration has died by exp(-0.25 t).
  EXPECT_NEAR(forces.back(), 0.9 / (1.0 / 4 + 0.25 / 25), 1e-6);
}

TEST(ModalIntegrator, MeetsItsTargetsAndTheEquationOfMotion) {
  const auto basis = random_basis(9);
  const NewmarkRule rule{0.01, 0.3025, 0.6};
  const Vector damping = Vector::Constant(9, 0.1), force = RandomValues(3).vector(9);
  ModalIntegrator body(basis, rule, damping, {{0, 0}, {2, 1}}, 6);
  const Vector target = Vector::Zero(2) + Vector2(basis->rest[0] + 0.02, basis->rest[7] - 0.01);
  for (int k = 1; k <= 20; ++k) body.step(force, target);
  const SpectralState& s = body.state();
  const Vector x = basis->positions(s.q);
  EXPECT_NEAR(x[0], target[0], 1e-12);
  EXPECT_NEAR(x[7], target[1], 1e-12);
  const Vector pull = basis->jacobian(0, s.q).row(0).transpose() * body.forces()[0] +
                      basis->jacobian(2, s.q).row(1).transpose() * body.forces()[1];
  const Vector out = s.a + damping.cwiseProduct(s.v) + basis->eigenvalues.cwiseProduct(s.q) - force - pull;
  EXPECT_LE(out.norm(), 1e-6 * pull.norm());
}

/// As printed the system of MW (A.14) is singular to working precision for small steps; rescaled it is not.
TEST(ModalIntegrator, TheRescaledSystemIsWellConditionedWhateverTheStep) {
  const auto basis = random_basis(9);
  for (const double h : {1e-2, 1e-3, 1e-4}) {
    const double reach = 0.25 * h * h;
    Matrix printed = Matrix::Zero(12, 12);
    printed.diagonal().head(9) = Vector::Ones(9) + reach * basis->eigenvalues;
    Matrix scaled = printed;
    const Matrix j = basis->shapes.topRows(3);
    printed.bottomLeftCorner(3, 9) = reach * j;
    printed.topRightCorner(9, 3) = reach * j.transpose();
    scaled.bottomLeftCorner(3, 9) = -j;
    scaled.topRightCorner(9, 3) = -j.transpose();
    const auto condition = [](const Matrix& m) {
      const Vector values = m.jacobiSvd().singularValues();
      return values[0] / values[values.size() - 1];
    };
    EXPECT_LT(condition(scaled), 100) << h;
    EXPECT_GT(condition(printed), 1e8) << h;
  }
}

}  // namespace
}  // namespace taut
