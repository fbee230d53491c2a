#include "support/derivative_check.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "support/random_values.h"

namespace taut {
namespace {

/// Remainders at steps t = 2^-5, 2^-6, ..., and the size below which they are round-off.
struct Remainders {
  static constexpr int count = 18;
  std::array<double, count> squares{};
  double floor;

  /// `scale`: the largest number that the function adds up on the way, as far as its derivatives tell.
  explicit Remainders(double scale) : floor(1e-13 * scale) {}
  static double step(int k) { return std::ldexp(1.0, -5 - k); }
  void add(int k, double remainder) { squares[k] += remainder * remainder; }
  /// The slope over the (up to) five smallest steps above round-off.
  Decay decay() const {
    std::vector<double> log_step, log_remainder;
    for (int k = count - 1; k >= 0 && log_step.size() < 5; --k) {
      const double remainder = std::sqrt(squares[k]);
      if (!std::isfinite(remainder)) return {};
      if (remainder <= floor) continue;
      log_step.push_back(std::log(step(k)));
      log_remainder.push_back(std::log(remainder));
    }
    // Fewer than three points leave no room for a slope; then even the largest remainder has to be near round-off.
    if (log_step.size() < 3) return {0.0, std::sqrt(squares[0]) <= 1e2 * floor};
    const Index n = static_cast<Index>(log_step.size());
    const Eigen::Map<const Vector> s(log_step.data(), n), r(log_remainder.data(), n);
    const Vector centred = (s.array() - s.mean()).matrix();
    return {centred.dot(r) / centred.squaredNorm(), false};
  }
};

double lowest_eigenvalue(const Matrix& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(0.5 * (symmetric + symmetric.transpose()), Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

}  // namespace

DerivativeReport check_derivatives(const Energy& energy, Index element, const Vector& x, unsigned seed) {
  const Index width = energy.stencils().width();
  Vector gradient(width), moved_gradient(width);
  Matrix exact(width, width), semidefinite(width, width);
  const double value = energy.evaluate(element, x.data(), gradient.data(), exact.data(), Curvature::exact);
  energy.evaluate(element, x.data(), moved_gradient.data(), semidefinite.data(), Curvature::positive_semidefinite);

  RandomValues random(seed);
  const double distance = 1 + x.norm(), bend = std::max(exact.norm(), semidefinite.norm());
  const double value_scale = std::abs(value) + distance * (gradient.norm() + distance * bend);
  Remainders first(value_scale), second(value_scale), slope(gradient.norm() + distance * bend);
  for (int sample = 0; sample < 4; ++sample) {
    const Vector direction = random.vector(width).normalized();
    const Vector turn = exact * direction;
    for (int k = 0; k < Remainders::count; ++k) {
      const double t = Remainders::step(k);
      const Vector moved = x + t * direction;
      const double moved_value =
          energy.evaluate(element, moved.data(), moved_gradient.data(), nullptr, Curvature::exact);
      const double linear = t * gradient.dot(direction), quadratic = 0.5 * t * t * direction.dot(turn);
      first.add(k, moved_value - value - linear);
      second.add(k, moved_value - value - linear - quadratic);
      slope.add(k, (moved_gradient - gradient - t * turn).norm());
    }
  }
  DerivativeReport report;
  report.first = first.decay();
  report.second = second.decay();
  report.gradient = slope.decay();
  const double size = std::max({exact.cwiseAbs().maxCoeff(), semidefinite.cwiseAbs().maxCoeff(), 1e-300});
  report.asymmetry = std::max((exact - exact.transpose()).cwiseAbs().maxCoeff(),
                              (semidefinite - semidefinite.transpose()).cwiseAbs().maxCoeff()) /
                     size;
  report.lowest = lowest_eigenvalue(semidefinite) / size;
  report.above_exact = lowest_eigenvalue(semidefinite - exact) / size;
  report.from_exact = (semidefinite - exact).cwiseAbs().maxCoeff() / size;
  report.exact_semidefinite = lowest_eigenvalue(exact) / size >= -1e-13;
  return report;
}

void expect_four_as_one(const Energy& energy, const Vector& x, const std::string& label) {
  const Stencils& stencils = energy.stencils();
  const int width = stencils.width();
  for (const Curvature curvature : {Curvature::exact, Curvature::positive_semidefinite}) {
    if (!energy.takes_four(curvature)) continue;
    for (Index quad = 0; quad < quads(stencils.count()); ++quad) {
      std::vector<Pack> four(width), four_gradient(width), four_hessian(width * width);
      stencils.gather(quad, x, four.data());
      const Pack value = energy.evaluate_four(quad, four.data(), four_gradient.data(), four_hessian.data(), curvature);
      for (int lane = 0; lane < Pack::size; ++lane) {
        const Index element = element_of(quad, lane, stencils.count());
        Vector local(width), gradient(width), gradient_of_lane(width);
        Matrix hessian(width, width), hessian_of_lane(width, width);
        stencils.gather(element, x, local.data());
        const double alone = energy.evaluate(element, local.data(), gradient.data(), hessian.data(), curvature);
        for (int i = 0; i < width; ++i) gradient_of_lane[i] = four_gradient[i][lane];
        for (int i = 0; i < width * width; ++i) hessian_of_lane.data()[i] = four_hessian[i][lane];
        const std::string where = label + ", element " + std::to_string(element) + " in lane " + std::to_string(lane);
        const double stiffness = hessian.norm(), force = gradient.norm() + x.norm() * stiffness;
        EXPECT_NEAR(value[lane], alone, 1e-13 * (std::abs(alone) + x.norm() * force)) << where;
        EXPECT_LE((gradient_of_lane - gradient).norm(), 1e-13 * force) << where;
        EXPECT_LE((hessian_of_lane - hessian).norm(), 1e-12 * stiffness) << where;
      }
    }
  }
}

void expect_derivatives(const Energy& energy, const Vector& x, SemidefiniteForm form, const std::string& label) {
  ASSERT_GT(energy.stencils().count(), 0) << label;
  expect_four_as_one(energy, x, label);
  Vector local(energy.stencils().width());
  for (Index element = 0; element < energy.stencils().count(); ++element) {
    energy.stencils().gather(element, x, local.data());
    const DerivativeReport report = check_derivatives(energy, element, local, static_cast<unsigned>(element) + 1);
    const std::string where = label + ", element " + std::to_string(element);
    EXPECT_TRUE(report.first.at_least(1.9)) << where << ": gradient against value, slope " << report.first.slope;
    EXPECT_TRUE(report.second.at_least(2.9)) << where << ": Hessian against value, slope " << report.second.slope;
    EXPECT_TRUE(report.gradient.at_least(1.9))
        << where << ": Hessian against gradient, slope " << report.gradient.slope;
    EXPECT_LE(report.asymmetry, 1e-13) << where;
    EXPECT_GE(report.lowest, -1e-12) << where;
    if (form != SemidefiniteForm::other) {
      EXPECT_GE(report.above_exact, -1e-12) << where;
    }
    if (form == SemidefiniteForm::projection && report.exact_semidefinite) {
      EXPECT_LE(report.from_exact, 1e-12) << where;
    }
  }
}

double Contraction::evaluate(Index element, const double* x, double* gradient, double* hessian,
                             Curvature curvature) const {
  const int rows = constraint_.rows(), width = stencils().width();
  const Vector lambda = multipliers_.segment(element * rows, rows);
  Vector c(rows);
  Matrix jacobian(rows, width);
  constraint_.evaluate(element, x, c.data(), gradient ? jacobian.data() : nullptr);
  if (gradient) Eigen::Map<Vector>(gradient, width) = jacobian.transpose() * lambda;
  if (hessian) constraint_.hessian(element, x, lambda.data(), curvature, hessian);
  return lambda.dot(c);
}

}  // namespace taut
