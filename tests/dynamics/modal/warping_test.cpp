#include "dynamics/modal/warping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "dynamics/modal/modal_energies.h"
#include "support/derivative_check.h"
#include "support/small_basis.h"

namespace taut {
namespace {

TEST(Warping, RotationIsThatOfAxisAndAngle) {
  for (const double angle : {1e-9, 1e-4, 0.3, 0.7, 0.71, 1.9, 3.1, 6.0}) {
    const Vector3 axis = Vector3(0.3, -0.5, 0.8).normalized();
    const Matrix3 expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_LE((warp_rotation(angle * axis) - expected).norm(), 1e-15 * 8) << angle;
  }
}

TEST(Warping, IntegralIsThatOfTheRotationAlongTheRamp) {
  // Gauss-Legendre with three points on each of 200 intervals: error below 1e-15.
  constexpr double at = 0.7745966692414834;
  for (const double angle : {1e-6, 0.2, 0.7, 0.72, 2.0, 5.0}) {
    const Vector3 w = angle * Vector3(0.6, -0.7, 0.2).normalized();
    Matrix3 sum = Matrix3::Zero();
    constexpr int parts = 200;
    for (int i = 0; i < parts; ++i) {
      for (const auto& [place, weight] : {std::pair(-at, 5.0 / 18), std::pair(0.0, 8.0 / 18), std::pair(at, 5.0 / 18)})
        sum += weight / parts * warp_rotation((i + 0.5 + 0.5 * place) / parts * w);
    }
    EXPECT_LE((warp_integral(w) - sum).norm(), 1e-13) << angle;
  }
}

/// A rigid rotation given as one ramp: d = w x p for a point p. (The curl of the field w x X is 2 w.)
TEST(Warping, ARigidRotationIsExactWithTheIntegralAndFarOffWithTheRotationAlone) {
  const Vector3 point(1, 0, 0);
  const double expected_errors[] = {0.05, 0.25, 0.51};  // ERRATA of MW: 5, 25 and 51 %
  int k = 0;
  for (const double angle : {0.1, 0.5, 1.0}) {
    const Vector3 w(0, 0, angle), d = w.cross(point);
    const Vector3 exact = Eigen::AngleAxisd(angle, Vector3::UnitZ()) * point - point;
    EXPECT_LE((warp_integral(w) * d - exact).norm(), 1e-15);
    EXPECT_NEAR((warp_rotation(w) * d - exact).norm() / exact.norm(), expected_errors[k++], 0.01) << angle;
  }
}

/// Tip of a cantilever bent to a circle: linear mode u_y = kappa x^2/2, rotation kappa x. Values: exact arc
/// ((sin t)/t - 1, (1 - cos t)/t) against the warped mode (-(1 - cos t)/2, (sin t)/2).
TEST(Warping, PureBendingHasTheErrorOfItsClosedForm) {
  struct Row {
    double degrees, warped_x, warped_y, error;
  };
  const Row rows[] = {{10, -0.007596123, 0.086824089, 0.002536546},
                      {30, -0.066987298, 0.250000000, 0.022690103},
                      {90, -0.500000000, 0.500000000, 0.193209535},
                      {180, -1.000000000, 0.000000000, 0.636619772}};
  for (const Row& row : rows) {
    const double t = row.degrees * std::numbers::pi / 180;
    const Vector3 u = warp_integral({0, 0, t}) * Vector3(0, t / 2, 0);
    const Vector3 exact(std::sin(t) / t - 1, (1 - std::cos(t)) / t, 0);
    EXPECT_NEAR(u.x(), row.warped_x, 1e-9);
    EXPECT_NEAR(u.y(), row.warped_y, 1e-9);
    EXPECT_NEAR((u - exact).norm(), row.error, 1e-9) << row.degrees;
  }
}

/// Largest error on the rim of a round bar at its end, u = theta x (-z, y), w = (theta x, -theta y/2, -theta z/2) with
/// theta the twist per length: the part off the axis is what is wrong. Relative to the largest exact displacement.
double torsion_error(double slenderness, double angle) {
  const double theta = angle;  // of a bar of length 1
  const Vector3 at(1, slenderness, 0);
  const Vector3 d = theta * at.x() * Vector3(0, -at.z(), at.y());
  const Vector3 w(theta * at.x(), -0.5 * theta * at.y(), -0.5 * theta * at.z());
  const Vector3 exact = Eigen::AngleAxisd(angle, Vector3::UnitX()) * at - at;
  return (warp_integral(w) * d - exact).norm() / exact.norm();
}

TEST(Warping, PureTorsionIsExactAsTheBarGetsSlenderWithAFirstOrderError) {
  EXPECT_NEAR(torsion_error(0.05, 0.5), 0.006, 0.0005);  // ERRATA of MW: .6 %
  for (const double slenderness : {0.1, 0.05, 0.025, 0.0125}) {
    EXPECT_NEAR(torsion_error(slenderness, 0.5) / torsion_error(slenderness / 2, 0.5), 2, 0.02) << slenderness;
  }
  EXPECT_LE(torsion_error(1e-12, 0.5), 1e-11);
}

TEST(WarpedLoad, WithFrozenRotationsIsLinearAndRightAtThem) {
  const auto basis = random_basis(8);
  const Vector q = RandomValues(2).vector(8);
  WarpedLoad free("load", *basis, RandomValues(4).vector(12)), frozen = free;
  frozen.freeze(q);
  expect_derivatives(frozen, q, SemidefiniteForm::projection, "frozen");
  EXPECT_NEAR(free.evaluate(0, q.data(), nullptr, nullptr, Curvature::exact),
              frozen.evaluate(0, q.data(), nullptr, nullptr, Curvature::exact), 1e-14);
}

TEST(ModalBasis, JacobianIsWhatMovesTheNodes) {
  const auto basis = random_basis(7);
  const Vector q = RandomValues(5).vector(7), v = RandomValues(6).vector(7);
  const Vector rates = basis->velocities(q, v);
  const double t = 1e-5;
  const Vector difference = (basis->positions(q + t * v) - basis->positions(q - t * v)) / (2 * t);
  EXPECT_LE((rates - difference).norm(), 1e-8 * rates.norm());
  for (Index node = 0; node < 4; ++node)
    EXPECT_LE((basis->jacobian(node, q) * v - rates.segment<3>(3 * node)).norm(), 1e-13);
}

TEST(ModalBasis, FindsTheCoordinatesOfItsOwnPositions) {
  const auto basis = random_basis(7);
  const Vector q = 0.3 * RandomValues(5).vector(7);
  EXPECT_LE((basis->coordinates(basis->positions(q), Vector::Zero(7)) - q).norm(), 1e-12);
}

}  // namespace
}  // namespace taut
