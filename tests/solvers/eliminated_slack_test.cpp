#include "solvers/eliminated_slack.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/assembly.h"
#include "support/random_values.h"
#include "support/specimens.h"

namespace taut {
namespace {

class SlackOfEveryConstraint : public testing::TestWithParam<ConstraintSpecimen> {
 protected:
  const std::shared_ptr<const Constraint> constraint_ = GetParam().make();
  const Index rows_ = constraint_->stencils().count() * constraint_->rows();
  EliminatedSlack slack_{*constraint_};
};

TEST_P(SlackOfEveryConstraint, HasTaylorSlopesTwoAndThree) {
  slack_.set_penalty(20.0);
  slack_.set_multipliers(1.0 *
                         RandomValues(2).vector(rows_));  // moves c by up to a twentieth: no pose comes near a kink
  for (Pose pose : all_poses()) {
    if (GetParam().kinks.contains(pose)) continue;
    expect_derivatives(slack_, posed(pose), SemidefiniteForm::majorant, to_string(pose));
  }
}

TEST_P(SlackOfEveryConstraint, GradientIsTheLagrangiansAtTheUpdatedMultipliers) {
  slack_.set_penalty(20.0);
  slack_.set_multipliers(RandomValues(2).vector(rows_));
  const Vector x = posed(Pose::stretched);
  Vector gradient, updated, change = Vector::Zero(x.size());
  Assembly(x.size(), {&slack_}, {}, 1).gradient(x, gradient);
  slack_.updated_multipliers(x, 1e300, updated);
  slack_.add_update_force(x, change);

  const auto lagrangian = [&](const Vector& multipliers) {
    Vector force = Vector::Zero(x.size()), local(slack_.stencils().width()), c(constraint_->rows());
    Matrix jacobian(constraint_->rows(), slack_.stencils().width());
    for (Index element = 0; element < slack_.stencils().count(); ++element) {
      slack_.stencils().gather(element, x, local.data());
      constraint_->evaluate(element, local.data(), c.data(), jacobian.data());
      const Vector part =
          jacobian.transpose() * multipliers.segment(element * constraint_->rows(), constraint_->rows());
      for (int k = 0; k < slack_.stencils().width(); ++k)
        force[slack_.stencils()[element][k]] += constraint_->weight(element) * part[k];
    }
    return force;
  };
  const double scale = gradient.norm();
  EXPECT_GT(scale, 0);
  EXPECT_LE((gradient - lagrangian(updated)).norm(), 1e-13 * scale);
  EXPECT_LE((change - (lagrangian(updated) - lagrangian(slack_.multipliers()))).norm(), 1e-13 * scale);
}

TEST_P(SlackOfEveryConstraint, UpdateIsCappedInNormAndKeepsItsDirection) {
  slack_.set_penalty(1e6);
  const Vector x = posed(Pose::stretched);
  Vector free, capped;
  slack_.updated_multipliers(x, 1e300, free);
  slack_.updated_multipliers(x, 2.0, capped);
  const int rows = constraint_->rows();
  for (Index first = 0; first < free.size(); first += rows) {
    const Vector expected = free.segment(first, rows) * std::min(1.0, 2.0 / free.segment(first, rows).norm());
    EXPECT_LE((capped.segment(first, rows) - expected).norm(), 1e-14);
  }
}

TEST_P(SlackOfEveryConstraint, PrimalDualStepReducesTheMismatchAtFirstOrderByItsFraction) {
  if (!GetParam().interior) GTEST_SKIP() << "an equality has no central path: its inverse is cut at 1e8";
  slack_.set_penalty(20.0);
  slack_.set_multipliers(RandomValues(2).vector(rows_));
  const double epsilon = 1.0, target = 0.7;  // wide, so that a step of 1e-5 is small everywhere
  const Vector x = posed(Pose::stretched), dx = 0.1 * RandomValues(3).vector(x.size()),
               multipliers = slack_.multipliers();
  const double before = slack_.set_point(x, epsilon, 1).mean_square, t = 1e-5;
  Vector step, shared;
  Vector unused = Vector::Zero(x.size());
  slack_.aim(target, 1, unused);
  slack_.multiplier_step(dx, 1, step);
  slack_.multiplier_step(dx, 3, shared);
  EXPECT_EQ(step, shared);
  const auto along = [&](double fraction) {
    slack_.set_multipliers(multipliers + fraction * step);
    return slack_.set_point(x + fraction * dx, epsilon + fraction * (target - epsilon), 2).mean_square;
  };
  const double ahead = along(t), behind = along(-t);
  EXPECT_GT(before, 1e-6);
  EXPECT_NEAR((ahead - behind) / (2 * t), -2 * before, 1e-5 * before);
}

TEST_P(SlackOfEveryConstraint, PrimalDualSystemForecastsTheForceOfTheSteppedMultipliers) {
  slack_.set_penalty(20.0);
  slack_.set_multipliers(RandomValues(2).vector(rows_));
  slack_.set_linearisation(EliminatedSlack::Linearisation::central_path);
  const Vector x = posed(Pose::stretched), dx = RandomValues(3).vector(x.size());
  slack_.set_point(x, 0.01, 1);
  expect_four_as_one(slack_, x, constraint_->name());
  // The system's left-hand side at dx, less the curvature of c itself, is the sum of w J^T (lambda + dlambda).
  Vector system = Vector::Zero(x.size()), forecast = Vector::Zero(x.size()), step;
  slack_.aim(0.004, 1, system);
  slack_.multiplier_step(dx, 1, step);
  const Vector stepped = slack_.multipliers() + step;
  const int width = slack_.stencils().width(), rows = constraint_->rows();
  Vector local(width), local_dx(width), gradient(width), c(rows), nearest(rows), rate(rows);
  Matrix exact(width, width), semidefinite(width, width), jacobian(rows, width), curvature(width, width),
      inverse(rows, rows);
  for (Index element = 0; element < slack_.stencils().count(); ++element) {
    slack_.stencils().gather(element, x, local.data());
    slack_.stencils().gather(element, dx, local_dx.data());
    constraint_->evaluate(element, local.data(), c.data(), jacobian.data());
    slack_.evaluate(element, local.data(), gradient.data(), exact.data(), Curvature::exact);
    slack_.evaluate(element, local.data(), gradient.data(), semidefinite.data(), Curvature::positive_semidefinite);
    const Vector y = c + slack_.multipliers().segment(element * rows, rows) / slack_.penalty();
    constraint_->set().project_smoothed(element, y.data(), 0.01, nearest.data(), inverse.data(), rate.data());
    const Vector smoothed = slack_.penalty() * (y - nearest);
    const double weight = constraint_->weight(element);
    constraint_->hessian(element, local.data(), smoothed.data(), Curvature::exact, curvature.data());
    const Vector held = exact * local_dx + gradient - weight * curvature * local_dx;
    const Vector force = weight * jacobian.transpose() * stepped.segment(element * rows, rows);
    for (int i = 0; i < width; ++i) {
      system[slack_.stencils()[element][i]] += held[i];
      forecast[slack_.stencils()[element][i]] += force[i];
    }
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Matrix>(semidefinite).eigenvalues()[0], -1e-10 * semidefinite.norm());
  }
  EXPECT_GT(forecast.norm(), 0);
  EXPECT_LE((system - forecast).norm(), 1e-9 * (forecast.norm() + step.norm()));
}

INSTANTIATE_TEST_SUITE_P(, SlackOfEveryConstraint, testing::ValuesIn(constraint_specimens()),
                         [](const auto& specimen) { return specimen.param.name; });

TEST(EliminatedSlack, IsTheMinimumOverTheSlackOfTheAugmentedLagrangian) {
  const auto constraint = constraint_specimens()[0].make();
  EliminatedSlack slack(*constraint);
  const double penalty = 5;
  slack.set_penalty(penalty);
  slack.set_multipliers(RandomValues(4).vector(constraint->stencils().count() * 3));
  Vector local(9), c(3), nearest(3);
  RandomValues random(5);
  for (Index element = 0; element < constraint->stencils().count(); ++element) {
    constraint->stencils().gather(element, posed(Pose::stretched), local.data());
    constraint->evaluate(element, local.data(), c.data(), nullptr);
    const Vector lambda = slack.multipliers().segment(3 * element, 3);
    const double value =
        slack.evaluate(element, local.data(), nullptr, nullptr, Curvature::exact) / constraint->weight(element);
    // c(x) + s in K, that is c - z with z any point of K: the value is the least of lambda.(c - z) + mu/2 |c - z|^2.
    const auto lagrangian = [&](const Vector& z) { return lambda.dot(c - z) + 0.5 * penalty * (c - z).squaredNorm(); };
    const Vector y = c + lambda / penalty;
    constraint->set().project(element, y.data(), nearest.data(), nullptr);
    EXPECT_NEAR(value, lagrangian(nearest), 1e-13 * (1 + std::abs(value)));
    for (int sample = 0; sample < 50; ++sample) {
      const Vector any = c + random.vector(3);
      constraint->set().project(element, any.data(), nearest.data(), nullptr);
      EXPECT_GE(lagrangian(nearest), value - 1e-13);
    }
  }
}

TEST(EliminatedSlack, RejectsMultipliersOfTheWrongSize) {
  const auto constraint = constraint_specimens()[0].make();
  EliminatedSlack slack(*constraint);
  EXPECT_THROW(slack.set_multipliers(Vector::Zero(2)), std::invalid_argument);
}

}  // namespace
}  // namespace taut
