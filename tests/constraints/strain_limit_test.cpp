#include "constraints/strain_limit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/meshes.h"
#include "support/random_values.h"
#include "support/specimens.h"

namespace taut {
namespace {

std::vector<RestTriangle> sheet_triangles() {
  return rest_triangles(specimen_sheet().triangles, specimen_sheet().vertices);
}

/// Local coordinates of each triangle of the sheet in a pose.
std::vector<Vector> locals(const Constraint& constraint, const Vector& x) {
  std::vector<Vector> all(static_cast<std::size_t>(constraint.stencils().count()), Vector(9));
  for (Index element = 0; element < constraint.stencils().count(); ++element) {
    constraint.stencils().gather(element, x, all[static_cast<std::size_t>(element)].data());
  }
  return all;
}

TEST(StrainLimit, MeasuresViolationInSingularValues) {
  const auto stretched = [](double sx, double sy) {
    return flatten(
        mapped(specimen_sheet().vertices, [&](const Vector3& v) { return Vector3(sx * v.x(), 0.3, sy * v.y()); }));
  };
  const StrainLimitTriangles limit = limit_on(sheet_triangles(), 0.9, 1.1);
  const MatrixStrainLimit matrix(limit);
  const SingularValueStrainLimit values(limit);
  const std::vector<std::array<double, 3>> expected{{1, 1, 0},     {1.1, 0.9, 0},   {1.25, 1, 0.15},
                                                    {1, 0.7, 0.2}, {1.2, 0.5, 0.4}, {0, 0, 0.9}};
  for (const auto& [sx, sy, violation] : expected) {
    const std::vector<Vector> all = locals(matrix, stretched(sx, sy));
    for (std::size_t t = 0; t < all.size(); ++t) {
      EXPECT_NEAR(matrix.violation(static_cast<Index>(t), all[t].data()), violation, 1e-14);
      EXPECT_NEAR(values.violation(static_cast<Index>(t), all[t].data()), violation, 1e-14);
    }
  }
}

TEST(StrainLimit, UpperLimitAloneToleratesCollapse) {
  const MatrixStrainLimit limit(limit_on(sheet_triangles(), 0, 1.1));
  const Vector x = Vector::Zero(27);
  EXPECT_EQ(limit.violation(0, x.data()), 0);
  Vector c(3), nearest(3);
  limit.evaluate(0, x.data(), c.data(), nullptr);
  limit.set().project(0, c.data(), nearest.data(), nullptr);
  EXPECT_EQ(c, nearest);
}

TEST(StrainLimit, ViolationOfANanIsNan) {
  const MatrixStrainLimit limit(limit_on(sheet_triangles(), 0.9, 1.1));
  Vector x = Vector::Zero(9);
  x[4] = std::nan("");
  EXPECT_TRUE(std::isnan(limit.violation(0, x.data())));
}

TEST(StrainLimit, DoesNotChangeUnderRigidMotion) {
  RandomValues random(1);
  const MatrixStrainLimit matrix(limit_on(sheet_triangles(), 0.85, 1.12));
  const SingularValueStrainLimit values(limit_on(sheet_triangles(), 0.85, 1.12));
  Vector c(3), moved_c(3);
  for (int sample = 0; sample < 20; ++sample) {
    const Matrix3 turn = random.rotation();
    const Vector3 shift = random.vector(3);
    Vector x = posed(Pose::stretched), moved = x;
    for (Index v = 0; v < x.size(); v += 3) moved.segment<3>(v) = turn * x.segment<3>(v) + shift;
    for (const Constraint* limit : {static_cast<const Constraint*>(&matrix), static_cast<const Constraint*>(&values)}) {
      const std::vector<Vector> here = locals(*limit, x), there = locals(*limit, moved);
      for (std::size_t t = 0; t < here.size(); ++t) {
        const Index element = static_cast<Index>(t);
        c.setZero();
        moved_c.setZero();
        limit->evaluate(element, here[t].data(), c.data(), nullptr);
        limit->evaluate(element, there[t].data(), moved_c.data(), nullptr);
        EXPECT_LE((c - moved_c).norm(), 1e-12 * c.norm());
        EXPECT_NEAR(limit->violation(element, here[t].data()), limit->violation(element, there[t].data()), 1e-12);
      }
    }
  }
}

TEST(StrainLimit, DoesNotChangeWhenTheRestFrameTurnsOrIsMirrored) {
  RandomValues random(2);
  const TriangleMesh mesh = specimen_sheet();
  const auto with_frame = [&](const Matrix2& frame) {
    std::vector<std::array<Vector2, 3>> corners;
    for (const Triangle& t : mesh.triangles) {
      corners.push_back({frame * mesh.vertices[t[0]].head<2>(), frame * mesh.vertices[t[1]].head<2>(),
                         frame * mesh.vertices[t[2]].head<2>()});
    }
    return rest_triangles(mesh.triangles, corners);
  };
  const Matrix2 mirror = Vector2(1, -1).asDiagonal();
  const Vector x = posed(Pose::stretched);
  const SingularValueStrainLimit plain(limit_on(sheet_triangles(), 0.85, 1.12));
  for (int sample = 0; sample < 10; ++sample) {
    const Matrix2 turn = Eigen::Rotation2Dd(3 * random.value()).toRotationMatrix();
    for (const Matrix2& frame : {turn, Matrix2(turn * mirror)}) {
      const SingularValueStrainLimit turned(limit_on(with_frame(frame), 0.85, 1.12));
      const std::vector<Vector> all = locals(plain, x);
      for (std::size_t t = 0; t < all.size(); ++t) {
        const Index element = static_cast<Index>(t);
        Vector2 c, turned_c;
        Matrix jacobian(2, 9), turned_jacobian(2, 9);
        plain.evaluate(element, all[t].data(), c.data(), jacobian.data());
        turned.evaluate(element, all[t].data(), turned_c.data(), turned_jacobian.data());
        EXPECT_LE((c - turned_c).norm(), 1e-13);
        EXPECT_LE((jacobian - turned_jacobian).norm(), 1e-12 * jacobian.norm());
        EXPECT_NEAR(plain.weight(element), turned.weight(element), 1e-14);
      }
    }
  }
}

TEST(StrainLimit, EliminationOfTheUpperLimitIsThePositivePartInClosedForm) {
  // Lambda+ = Pi_+(Z), Z = Lambda + mu (C - dmax^2 I) = [a b; b c]: with m and r its mean and radius,
  // Pi_+(Z) = (z1+ + z2+)/2 I + (z1+ - z2+)/(z1 - z2) (Z - m I).
  RandomValues random(3);
  const double penalty = 7, upper = 1.21, root2 = std::numbers::sqrt2;
  const SpectralBox set(-std::numeric_limits<double>::infinity(), upper);
  for (int sample = 0; sample < 300; ++sample) {
    const Vector3 c = Vector3(1.2 + 0.3 * random.value(), 0.3 * random.value(), 1.2 + 0.3 * random.value());
    const Vector3 lambda(random.value(), random.value(), random.value());
    const Vector3 y = c + lambda / penalty;
    Vector3 nearest;
    set.project(0, y.data(), nearest.data(), nullptr);
    const Vector3 updated = penalty * (y - nearest);
    const double a = lambda[0] + penalty * (c[0] - upper), b = (lambda[1] + penalty * c[1]) / root2,
                 d = lambda[2] + penalty * (c[2] - upper);
    const double mean = 0.5 * (a + d), radius = std::hypot(0.5 * (a - d), b);
    const double high = std::max(mean + radius, 0.0), low = std::max(mean - radius, 0.0),
                 omega = (high - low) / (2 * radius);
    EXPECT_NEAR(updated[0], 0.5 * (high + low) + omega * (a - mean), 1e-13);
    EXPECT_NEAR(updated[1], root2 * omega * b, 1e-13);
    EXPECT_NEAR(updated[2], 0.5 * (high + low) + omega * (d - mean), 1e-13);
  }
}

TEST(StrainLimit, KeepsStepsFromReachingCollapseOnlyUnderALowerLimit) {
  const std::vector<RestTriangle> triangles = sheet_triangles();
  EXPECT_FALSE(MatrixStrainLimit(limit_on(triangles, 0, 1.1)).guards_steps());
  const MatrixStrainLimit limit(limit_on(triangles, 0.9, 1.1));
  EXPECT_TRUE(limit.guards_steps());
  Vector x(9), dx(9);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0;
  dx << 0, 0, 0, 0, 0, 0, 0, -1, 0;  // the height shrinks from 1 to 0: a tenth of it is left after 0.9
  EXPECT_NEAR(limit.largest_step(0, x.data(), dx.data()), 0.9, 1e-15);
  const Vector back = -dx, twice = 2 * dx;
  EXPECT_EQ(limit.largest_step(0, x.data(), back.data()), std::numeric_limits<double>::infinity());
  EXPECT_NEAR(limit.largest_step(0, x.data(), twice.data()), 0.45, 1e-15);
  RandomValues random(4);
  for (int sample = 0; sample < 200; ++sample) {
    const Vector step = 3 * random.vector(9);
    const double fraction = limit.largest_step(0, x.data(), step.data());
    const auto area = [&](double t) {
      const Vector p = x + t * step;
      return (p.segment<3>(3) - p.segment<3>(0)).cross(p.segment<3>(6) - p.segment<3>(0)).z();
    };
    if (std::isfinite(fraction)) {
      EXPECT_NEAR(area(fraction), 0.1, 1e-12);
    }
    for (int k = 0; k < 20; ++k) EXPECT_GE(area(std::min(fraction, 2.0) * k / 20.0), 0.1 - 1e-12);
  }
}

TEST(StrainLimit, RejectsBoundsAndIdsThatDoNotFit) {
  const std::vector<RestTriangle> triangles = sheet_triangles();
  EXPECT_THROW(MatrixStrainLimit(limit_on(triangles, 1.2, 1.1)), std::invalid_argument);
  EXPECT_THROW(MatrixStrainLimit(limit_on(triangles, -0.1, 1.1)), std::invalid_argument);
  EXPECT_THROW(SingularValueStrainLimit(limit_on(triangles, 0, std::nan(""))), std::invalid_argument);
  StrainLimitTriangles limit = limit_on(triangles, 0, 1.1);
  limit.ids.pop_back();
  EXPECT_THROW(MatrixStrainLimit{limit}, std::invalid_argument);
}

}  // namespace
}  // namespace taut
