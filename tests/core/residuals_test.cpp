#include "core/residuals.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "constraints/obstacle.h"
#include "energies/dead_load.h"
#include "energies/membrane.h"
#include "support/meshes.h"
#include "support/random_values.h"
#include "support/specimens.h"

namespace taut {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The stretched specimen sheet with a membrane and a limit, random multipliers, two vertices held where they are.
class JudgedSheet : public testing::Test {
 protected:
  const TriangleMesh mesh_ = specimen_sheet();
  const std::vector<RestTriangle> triangles_ = rest_triangles(mesh_.triangles, mesh_.vertices);
  const std::shared_ptr<const Energy> membrane_ = energy_specimens()[3].make();
  const MatrixStrainLimit limit_{limit_on(triangles_, 0.85, 1.12)};
  Problem problem_;
  Result result_;

  void SetUp() override {
    result_.x = posed(Pose::stretched);
    problem_.initial_guess = result_.x;
    problem_.energies = {membrane_.get()};
    problem_.constraints = {&limit_};
    problem_.fixed_variables = {0, 1, 2, 24, 25, 26};
    problem_.fixed_values.resize(6);
    for (int i = 0; i < 6; ++i)
      problem_.fixed_values[i] = result_.x[problem_.fixed_variables[static_cast<std::size_t>(i)]];
    result_.multipliers = {RandomValues(1).vector(3 * limit_.stencils().count())};
  }

  /// f + sum of weighted multipliers times constraints, from values only.
  double lagrangian(const Vector& x) const {
    double sum = 0;
    Vector local(9), c(3);
    for (Index element = 0; element < limit_.stencils().count(); ++element) {
      limit_.stencils().gather(element, x, local.data());
      limit_.evaluate(element, local.data(), c.data(), nullptr);
      sum += membrane_->evaluate(element, local.data(), nullptr, nullptr, Curvature::exact) +
             limit_.weight(element) * c.dot(result_.multipliers[0].segment(3 * element, 3));
    }
    return sum;
  }
};

TEST_F(JudgedSheet, StationarityIsTheLargestNodalDifferenceQuotientOfTheLagrangian) {
  const double step = 1e-5;
  double largest = 0;
  for (Index vertex = 1; vertex < result_.x.size() / 3 - 1; ++vertex) {
    Vector3 slope;
    for (int axis = 0; axis < 3; ++axis) {
      Vector up = result_.x, down = result_.x;
      up[3 * vertex + axis] += step;
      down[3 * vertex + axis] -= step;
      slope[axis] = (lagrangian(up) - lagrangian(down)) / (2 * step);
    }
    largest = std::max(largest, slope.norm());
  }
  const Residuals judged = residuals(problem_, result_);
  EXPECT_NEAR(judged.stationarity_unscaled, largest, 1e-7 * largest);
  EXPECT_DOUBLE_EQ(judged.stationarity, judged.stationarity_unscaled / judged.force_scale);
  EXPECT_GE(judged.force_scale, largest / 3);  // three terms: membrane, limit, pins
}

TEST_F(JudgedSheet, FeasibilityIsTheLargestDistanceOfAJacobiSingularValue) {
  double largest = 0;
  int worst = -1;
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    Vector local(9);
    limit_.stencils().gather(t, result_.x, local.data());
    const Vector2 d =
        Eigen::JacobiSVD<Matrix32>(triangles_[static_cast<std::size_t>(t)].deformation_gradient(local.data()))
            .singularValues();
    const double violation = std::max(d[0] - 1.12, 0.85 - d[1]);
    if (violation > largest) {
      largest = violation;
      worst = t;
    }
  }
  const Residuals judged = residuals(problem_, result_);
  ASSERT_EQ(judged.violations.size(), 2u);
  EXPECT_NEAR(judged.violations[0].max, largest, 1e-14);
  EXPECT_EQ(judged.violations[0].element, worst);
  EXPECT_EQ(judged.violations[0].where, "triangle " + std::to_string(worst) + " of cloth");
  EXPECT_DOUBLE_EQ(judged.feasibility, judged.violations[0].max);
  EXPECT_EQ(judged.violations[1].constraint, "pins");
  EXPECT_EQ(judged.violations[1].max, 0);
  EXPECT_EQ(judged.violations[1].where, "");
}

TEST_F(JudgedSheet, SeesAPinThatMoved) {
  result_.x[25] += 1e-3;
  const Residuals judged = residuals(problem_, result_);
  EXPECT_NEAR(judged.violations[1].max, 1e-3, 1e-15);
  EXPECT_EQ(judged.violations[1].where, "vertex 8");
  EXPECT_GT(judged.feasibility, 1e-4);
}

TEST_F(JudgedSheet, IsNeverWithinToleranceWhereANumberIsNotFinite) {
  const Tolerances loose{1e300, 1e300, 1e300};
  ASSERT_TRUE(residuals(problem_, result_).within(loose));
  for (double bad : {nan, std::numeric_limits<double>::infinity()}) {
    for (Index i : {Index{0}, Index{5}, result_.x.size() - 1}) {
      Result broken = result_;
      broken.x[i] = bad;
      EXPECT_FALSE(residuals(problem_, broken).within(loose)) << i;
    }
    for (Index i : {Index{0}, result_.multipliers[0].size() - 1}) {
      Result broken = result_;
      broken.multipliers[0][i] = bad;
      EXPECT_FALSE(residuals(problem_, broken).within(loose)) << i;
    }
    Problem pinned = problem_;
    pinned.fixed_values[0] = bad;
    EXPECT_FALSE(residuals(pinned, result_).within(loose));
  }
}

TEST_F(JudgedSheet, IsNeverWithinToleranceOutsideAnEnergysDomain) {
  const Membrane membrane("membrane", triangles_, MembraneLaw::neo_hookean, Lame::plane_stress(100, 0.3), 1.0);
  problem_.energies = {&membrane};
  problem_.fixed_variables.clear();
  problem_.fixed_values.resize(0);
  result_.x *= 0;  // every triangle is a point: infinite energy, no direction
  EXPECT_FALSE(residuals(problem_, result_).finite);
}

TEST_F(JudgedSheet, ThrowsWhereSizesDoNotFit) {
  const auto judge = [&](const auto& change) {
    Result broken = result_;
    change(broken);
    return residuals(problem_, broken);
  };
  EXPECT_THROW(judge([](Result& r) { r.x.conservativeResize(3); }), std::invalid_argument);
  EXPECT_THROW(judge([](Result& r) { r.multipliers.clear(); }), std::invalid_argument);
  EXPECT_THROW(judge([](Result& r) { r.multipliers[0].conservativeResize(3); }), std::invalid_argument);
}

/// One vertex under its weight on the floor z = 0, whose contact force is 2 N: the solved problem, to be spoiled.
class VertexOnFloor : public testing::Test {
 protected:
  const DeadLoad weight_{"weight", Vector3(0, 0, -2)};
  HalfSpace floor_{"floor", "ball", {0}, 0, 1.0};
  Problem problem_;
  Result result_;
  void SetUp() override {
    problem_.initial_guess = Vector{{1, 1, 0}};
    problem_.energies = {&weight_};
    problem_.constraints = {&floor_};
    result_.x = problem_.initial_guess;
    result_.multipliers = {Vector::Constant(1, -2.0)};
  }
  Residuals judged() const { return residuals(problem_, result_); }
};

TEST_F(VertexOnFloor, IsSolvedExactly) {
  EXPECT_EQ(judged().stationarity, 0);
  EXPECT_EQ(judged().feasibility, 0);
  EXPECT_EQ(judged().complementarity, 0);
  EXPECT_EQ(judged().force_scale, 2);
  EXPECT_TRUE(judged().within({}));
}

TEST_F(VertexOnFloor, CatchesAMultiplierOfTheWrongSign) {
  result_.multipliers[0][0] = 2;
  EXPECT_DOUBLE_EQ(judged().stationarity, 2);
  EXPECT_DOUBLE_EQ(judged().complementarity, 1);
  EXPECT_FALSE(judged().within({}));
}

TEST_F(VertexOnFloor, CatchesAWrongSignBelowTheFloorToo) {
  result_.multipliers[0][0] = 2;
  result_.x[2] = -3;
  EXPECT_DOUBLE_EQ(judged().complementarity, 1);
}

TEST_F(VertexOnFloor, CatchesAMissingMultiplier) {
  result_.multipliers[0][0] = 0;
  EXPECT_DOUBLE_EQ(judged().stationarity, 1);
  EXPECT_FALSE(judged().within({}));
}

TEST_F(VertexOnFloor, CatchesAMultiplierWithoutContact) {
  result_.x[2] = 0.25;
  EXPECT_EQ(judged().stationarity, 0);
  EXPECT_DOUBLE_EQ(judged().complementarity, 0.25);
  EXPECT_DOUBLE_EQ(judged().complementarity_unscaled, 0.5);
  result_.x[2] = 5;
  EXPECT_DOUBLE_EQ(judged().complementarity, 1);
}

TEST_F(VertexOnFloor, MeasuresPenetration) {
  result_.x[2] = -0.125;
  EXPECT_DOUBLE_EQ(judged().feasibility, 0.125);
  EXPECT_EQ(judged().violations[0].where, "vertex 0 of ball");
}

/// c(x) = x for three variables, in the spectral box.
class Identity final : public Constraint {
 public:
  Identity() { stencils_.add_vertices(std::array{0}); }
  std::string name() const override { return "identity"; }
  const Stencils& stencils() const override { return stencils_; }
  int rows() const override { return 3; }
  const ConvexSet& set() const override { return set_; }
  void evaluate(Index /*element*/, const double* x, double* c, double* jacobian) const override {
    std::copy_n(x, 3, c);
    if (jacobian) Eigen::Map<Matrix3>{jacobian}.setIdentity();
  }
  void hessian(Index, const double*, const double*, Curvature, double* hessian) const override {
    std::fill_n(hessian, 9, 0.0);
  }
  double violation(Index, const double*) const override { return 0; }
  std::string element_name(Index) const override { return "it"; }

 private:
  Stencils stencils_{3};
  SpectralBox set_{0.5, 1.5};
};

TEST(Complementarity, IsZeroExactlyForNormalsOfTheSet) {
  const Identity constraint;
  Problem problem;
  problem.initial_guess = Vector::Zero(3);
  problem.constraints = {&constraint};
  const auto complementarity = [&](const Vector3& c, const Vector3& lambda) {
    Result result;
    result.x = Vector(c);
    result.multipliers = {lambda};
    return residuals(problem, result).complementarity;
  };
  RandomValues random(3);
  for (int sample = 0; sample < 200; ++sample) {
    // z - P z is a normal at P z; its opposite is none, and neither is it one inside the set.
    const Vector3 z = Vector3(1, 0, 1) + 2 * Vector3(random.vector(3));
    Vector3 nearest;
    constraint.set().project(0, z.data(), nearest.data(), nullptr);
    const Vector3 normal = z - nearest;
    if (normal.norm() < 0.1) continue;
    EXPECT_LE(complementarity(nearest, normal), 1e-14);
    EXPECT_GE(complementarity(nearest, -normal), 0.1);
    EXPECT_GE(complementarity({1, 0, 1}, normal), 0.3);
    EXPECT_EQ(complementarity(nearest, Vector3::Zero()), 0);
  }
}

TEST(Tolerances, HaveToBePositive) {
  EXPECT_NO_THROW(Tolerances{}.validate());
  EXPECT_THROW((Tolerances{0, 1, 1}.validate()), std::invalid_argument);
  EXPECT_THROW((Tolerances{1, nan, 1}.validate()), std::invalid_argument);
  EXPECT_THROW((Tolerances{1, 1, -1}.validate()), std::invalid_argument);
}

}  // namespace
}  // namespace taut
