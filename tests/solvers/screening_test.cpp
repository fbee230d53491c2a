// Constraints that are left out of a solve because nothing seemed able to reach them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "constraints/convex_sets.h"
#include "solvers/augmented_lagrangian.h"
#include "support/problems.h"

namespace taut {
namespace {

/// |x - target|^n/n, n even.
class Pull final : public Energy {
 public:
  Pull(double target, int power) : target_(target), power_(power) { stencils_.add(std::array{0}); }
  std::string name() const override { return "pull"; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index, const double* x, double* gradient, double* hessian, Curvature) const override {
    const double away = *x - target_;
    if (gradient) *gradient = std::pow(away, power_ - 1);
    if (hessian) *hessian = (power_ - 1) * std::pow(away, power_ - 2);
    return std::pow(away, power_) / power_;
  }

 private:
  double target_;
  int power_;
  Stencils stencils_{1};
};

/// x <= 1.
class Wall final : public Constraint {
 public:
  Wall() { stencils_.add(std::array{0}); }
  std::string name() const override { return "wall"; }
  const Stencils& stencils() const override { return stencils_; }
  int rows() const override { return 1; }
  const ConvexSet& set() const override { return set_; }
  void evaluate(Index, const double* x, double* c, double* jacobian) const override {
    *c = *x;
    if (jacobian) *jacobian = 1;
  }
  void hessian(Index, const double*, const double*, Curvature, double* hessian) const override { *hessian = 0; }
  double violation(Index, const double* x) const override { return std::max(*x - 1, 0.0); }
  std::string element_name(Index) const override { return "x"; }

 private:
  Stencils stencils_{1};
  Box set_{1, -std::numeric_limits<double>::infinity(), 1};
};

/// A step from x = 0 with these energies behind the wall, and what the step before knows about it.
Result solved(const std::vector<Pull>& pulls, double last_change, double last_multiplier = 0, double screening = 4) {
  OwnedProblem owned;
  owned.problem.initial_guess = Vector::Zero(1);
  owned.problem.node_size = 1;
  for (const Pull& pull : pulls) owned.add(std::make_shared<Pull>(pull));
  owned.add(std::make_shared<Wall>());
  AugmentedLagrangianOptions options;
  options.screening = screening;
  WarmStart warm;
  warm.multipliers = {Vector::Constant(1, last_multiplier)};
  warm.changes = {last_change};
  return AugmentedLagrangian(options).solve(owned.problem, warm, {});
}

Result pulled(double target, double last_change, double last_multiplier = 0, double screening = 4) {
  return solved({Pull(target, 2)}, last_change, last_multiplier, screening);
}

TEST(Screening, LeavesOutWhatIsFartherThanFourChanges) {
  const Result result = pulled(0.5, 0.2);
  EXPECT_EQ(result.status, Status::solved);
  EXPECT_EQ(result.counts.screened, 1);
  EXPECT_EQ(result.counts.screening_failures, 0);
  EXPECT_EQ(result.counts.linear_solves, 1) << "a quadratic without constraints";
  EXPECT_DOUBLE_EQ(result.x[0], 0.5);
  EXPECT_DOUBLE_EQ(result.changes.at(0), 0.5);
}

TEST(Screening, HoldsWhereTheStepTakesManyIterations) {
  const Result result = solved({Pull(1, 20), Pull(0, 20)}, 0.2);
  EXPECT_EQ(result.status, Status::solved) << result.message;
  EXPECT_EQ(result.counts.screened, 1);
  EXPECT_NEAR(result.x[0], 0.5, 1e-6);
  EXPECT_GT(result.counts.linear_solves, 8) << "the residuals are looked at every eight";
  ASSERT_EQ(result.multipliers.size(), 1u);
  EXPECT_EQ(result.multipliers[0], Vector::Zero(1));
}

TEST(Screening, KeepsWhatIsNearerOrActiveAndEverythingWhereItIsOff) {
  EXPECT_EQ(pulled(0.5, 0.3).counts.screened, 0);
  EXPECT_EQ(pulled(0.5, 0.2, 0.1).counts.screened, 0);
  EXPECT_EQ(pulled(0.5, 0.2, 0, 0).counts.screened, 0);
}

/// Whether there is anything that more iterations could reach is no matter of what was left out and is kept.
TEST(Screening, IsNoReasonToBeginAgainWhereTheToleranceCannotBeReached) {
  OwnedProblem owned;
  owned.problem.initial_guess = Vector::Zero(1);
  owned.problem.node_size = 1;
  owned.add(std::make_shared<Pull>(0.3, 4));
  owned.add(std::make_shared<Pull>(0.4, 4));
  owned.add(std::make_shared<Wall>());
  AugmentedLagrangianOptions options;
  options.tolerances = {1e-300, 1e-300, 1e-300};
  WarmStart warm;
  warm.multipliers = {Vector::Zero(1)};
  warm.changes = {0.2};
  const Result result = AugmentedLagrangian(options).solve(owned.problem, warm, {});
  EXPECT_NE(result.status, Status::solved);
  EXPECT_EQ(result.counts.screened, 1);
  EXPECT_EQ(result.counts.screening_failures, 0);
  EXPECT_NEAR(result.x[0], 0.35, 1e-6);
}

/// x_k <= 1 for each variable.
class Walls final : public Constraint {
 public:
  Walls() {
    for (int k = 0; k < 2; ++k) stencils_.add(std::array{k});
  }
  std::string name() const override { return "walls"; }
  const Stencils& stencils() const override { return stencils_; }
  int rows() const override { return 1; }
  const ConvexSet& set() const override { return wall_.set(); }
  void evaluate(Index, const double* x, double* c, double* jacobian) const override {
    wall_.evaluate(0, x, c, jacobian);
  }
  void hessian(Index, const double* x, const double* lambda, Curvature curvature, double* hessian) const override {
    wall_.hessian(0, x, lambda, curvature, hessian);
  }
  double violation(Index, const double* x) const override { return wall_.violation(0, x); }
  std::string element_name(Index element) const override { return "x" + std::to_string(element); }

 private:
  Wall wall_;
  Stencils stencils_{1};
};

/// |x - target|^2/2 of two variables.
class TwoPulls final : public Energy {
 public:
  TwoPulls(double first, double second) : pulls_{Pull(first, 2), Pull(second, 2)} {
    for (int k = 0; k < 2; ++k) stencils_.add(std::array{k});
  }
  std::string name() const override { return "pulls"; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override {
    return pulls_[static_cast<std::size_t>(element)].evaluate(0, x, gradient, hessian, curvature);
  }

 private:
  std::array<Pull, 2> pulls_;
  Stencils stencils_{1};
};

TEST(Screening, LeavesOutSingleElements) {
  for (const double second : {0.5, 3.0}) {  // where it was left out rightly and not
    OwnedProblem owned;
    owned.problem.initial_guess = Eigen::Vector2d(0.9, 0);
    owned.problem.node_size = 1;
    owned.add(std::make_shared<TwoPulls>(3, second));
    owned.add(std::make_shared<Walls>());
    WarmStart warm;
    warm.multipliers = {Vector::Zero(2)};
    warm.changes = {0.2};
    const Result result = AugmentedLagrangian().solve(owned.problem, warm, {});
    EXPECT_EQ(result.status, Status::solved) << result.message;
    EXPECT_EQ(result.counts.screened, second < 1 ? 1 : 0);
    EXPECT_EQ(result.counts.screening_failures, second < 1 ? 0 : 1);
    EXPECT_NEAR(result.x[0], 1, 1e-6);
    EXPECT_NEAR(result.x[1], std::min(second, 1.0), 1e-6);
    EXPECT_NEAR(result.multipliers.at(0)[1], std::max(second - 1, 0.0), 1e-6);
  }
}

TEST(Screening, ThatFailsIsSeenAndSolvedAgain) {
  for (const double target : {1 + 1e-7, 3.0}) {  // within the tolerance of feasibility, and far beyond
    const Result result = pulled(target, 0.2), never = pulled(target, 0.2, 0, 0);
    EXPECT_EQ(result.status, Status::solved);
    EXPECT_EQ(result.counts.screened, 0);
    EXPECT_EQ(result.counts.screening_failures, 1);
    EXPECT_EQ(result.x, never.x);
    EXPECT_EQ(result.multipliers, never.multipliers);
  }
}

}  // namespace
}  // namespace taut
