#include "solvers/nonlinear_program.h"

#include <gtest/gtest.h>

#include <numeric>

#include "constraints/obstacle.h"
#include "energies/hinge_bending.h"
#include "energies/membrane.h"
#include "support/meshes.h"
#include "support/problems.h"
#include "support/random_values.h"
#include "support/specimens.h"

namespace taut {
namespace {

/// sigma f + nu . g of a whole program as one element: what Ipopt is told of gradient, Jacobian and Hessian.
class Lagrangian final : public Energy {
 public:
  Lagrangian(NonlinearProgram& program, double sigma, Vector nu)
      : program_(program), sigma_(sigma), nu_(std::move(nu)), stencils_(static_cast<int>(program.variables())) {
    std::vector<int> all(static_cast<std::size_t>(program.variables()));
    std::iota(all.begin(), all.end(), 0);
    stencils_.add(all);
  }
  std::string name() const override { return "lagrangian"; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index, const double* x, double* gradient, double* hessian, Curvature) const override {
    const Index n = program_.variables();
    const Vector y = Eigen::Map<const Vector>(x, n);
    Vector g, part, values;
    program_.constraints(y, g);
    if (gradient) {
      program_.gradient(y, part);
      program_.jacobian(y, values);
      Vector sum = sigma_ * part;
      const TripletPattern& at = program_.jacobian_pattern();
      for (std::size_t k = 0; k < at.rows.size(); ++k)
        sum[at.columns[k]] += nu_[at.rows[k]] * values[static_cast<Index>(k)];
      Eigen::Map<Vector>(gradient, n) = sum;
    }
    if (hessian) {
      program_.hessian(y, sigma_, nu_, values);
      Matrix dense = Matrix::Zero(n, n);
      const TripletPattern& at = program_.hessian_pattern();
      for (std::size_t k = 0; k < at.rows.size(); ++k)
        dense(at.rows[k], at.columns[k]) += values[static_cast<Index>(k)];
      Eigen::Map<Matrix>(hessian, n, n) = dense.selfadjointView<Eigen::Lower>();
    }
    return sigma_ * program_.objective(y) + nu_.dot(g);
  }

 private:
  NonlinearProgram& program_;
  double sigma_;
  Vector nu_;
  Stencils stencils_;
};

/// The specimen sheet with a membrane, bending and one constraint; some vertices held, one of them in one coordinate.
OwnedProblem sheet(const ConstraintSpecimen& specimen, Pose pose) {
  const TriangleMesh mesh = specimen_sheet();
  OwnedProblem owned;
  owned.problem.initial_guess = posed(pose);
  owned.add(std::make_shared<Membrane>("membrane", rest_triangles(mesh.triangles, mesh.vertices), MembraneLaw::stvk,
                                       Lame::plane_stress(2, 0.3), 1.0));
  owned.add(std::make_shared<HingeBending>("bending", make_hinges(mesh.triangles, mesh.vertices, 0.1, false)));
  owned.add(specimen.make());
  owned.problem.fixed_variables = {0, 1, 2, 7};
  owned.problem.fixed_values = owned.problem.initial_guess(owned.problem.fixed_variables);
  return owned;
}

class EveryConstraintAsSmoothRows : public testing::TestWithParam<ConstraintSpecimen> {};

TEST_P(EveryConstraintAsSmoothRows, HasLagrangianDerivativesAtTaylorSlopesTwoAndThree) {
  for (Pose pose : all_poses()) {
    if (GetParam().kinks.contains(pose)) continue;
    const OwnedProblem owned = sheet(GetParam(), pose);
    NonlinearProgram program(owned.problem);
    for (double sigma : {1.0, 0.0}) {
      const Lagrangian lagrangian(program, sigma, RandomValues(11).vector(program.rows()));
      const DerivativeReport report = check_derivatives(lagrangian, 0, program.start(), 3);
      EXPECT_TRUE(report.first.at_least(1.9)) << to_string(pose) << " slope " << report.first.slope;
      EXPECT_TRUE(report.second.at_least(2.9)) << to_string(pose) << " slope " << report.second.slope;
      EXPECT_TRUE(report.gradient.at_least(1.9)) << to_string(pose) << " slope " << report.gradient.slope;
    }
  }
}

TEST_P(EveryConstraintAsSmoothRows, HoldExactlyWhereTheSetHoldsTheValue) {
  for (Pose pose : all_poses()) {
    const OwnedProblem owned = sheet(GetParam(), pose);
    const Constraint& constraint = *owned.constraints[0];
    const NonlinearProgram program(owned.problem);
    Vector g, local(constraint.stencils().width());
    program.constraints(program.start(), g);
    const int rows = constraint.set().smooth_rows();
    for (Index element = 0; element < constraint.stencils().count(); ++element) {
      constraint.stencils().gather(element, owned.problem.initial_guess, local.data());
      bool inside = true;
      for (Index i = element * rows; i < (element + 1) * rows; ++i)
        inside = inside && g[i] >= program.lower()[i] && g[i] <= program.upper()[i];
      EXPECT_EQ(inside, constraint.violation(element, local.data()) == 0) << to_string(pose) << " " << element;
    }
  }
}

TEST_P(EveryConstraintAsSmoothRows, GiveTheForcesOfTheMultipliersTheyAreMappedTo) {
  const OwnedProblem owned = sheet(GetParam(), Pose::stretched);
  const Constraint& constraint = *owned.constraints[0];
  NonlinearProgram program(owned.problem);
  const Vector y = program.start(), nu = RandomValues(2).vector(program.rows());
  const std::vector<Vector> lambda = program.multipliers(y, nu);

  Vector values, forces = Vector::Zero(program.variables()), expected = Vector::Zero(owned.problem.size());
  program.jacobian(y, values);
  for (std::size_t k = 0; k < program.jacobian_pattern().rows.size(); ++k) {
    forces[program.jacobian_pattern().columns[k]] +=
        nu[program.jacobian_pattern().rows[k]] * values[static_cast<Index>(k)];
  }
  const Stencils& stencils = constraint.stencils();
  Vector local(stencils.width()), c(constraint.rows());
  Matrix jacobian(constraint.rows(), stencils.width());
  for (Index element = 0; element < stencils.count(); ++element) {
    stencils.gather(element, owned.problem.initial_guess, local.data());
    constraint.evaluate(element, local.data(), c.data(), jacobian.data());
    const Vector part = constraint.weight(element) * jacobian.transpose() *
                        lambda[0].segment(element * constraint.rows(), constraint.rows());
    for (int i = 0; i < stencils.width(); ++i) expected[stencils[element][i]] += part[i];
  }
  Vector full = Vector::Zero(owned.problem.size());
  Index next = 0;
  for (Index i = 0; i < full.size(); ++i) {
    const bool fixed = i < 3 || i == 7;
    if (fixed) expected[i] = 0;
    if (!fixed) full[i] = forces[next++];
  }
  EXPECT_LE((full - expected).norm(), 1e-13 * expected.norm());
  // And back: whatever multipliers the rows can represent come out again.
  const std::vector<Vector> again = program.multipliers(y, program.row_multipliers(y, lambda));
  EXPECT_LE((again[0] - lambda[0]).norm(), 1e-12 * lambda[0].norm());
}

INSTANTIATE_TEST_SUITE_P(, EveryConstraintAsSmoothRows, testing::ValuesIn(constraint_specimens()),
                         [](const auto& specimen) { return specimen.param.name; });

TEST(NonlinearProgram, SubstitutesFixedVariablesAndFollowsAProblemOfTheSameTopology) {
  OwnedProblem owned = sheet(constraint_specimens()[0], Pose::bent);
  owned.problem.topology = new_topology();
  owned.problem.initial_guess.setConstant(0.5);
  NonlinearProgram program(owned.problem);
  EXPECT_EQ(program.variables(), owned.problem.size() - 4);
  EXPECT_EQ(program.expand(program.start())(owned.problem.fixed_variables), owned.problem.fixed_values);
  ASSERT_TRUE(program.fits(owned.problem));
  owned.problem.fixed_values *= 2;
  program.update(owned.problem);
  EXPECT_EQ(program.expand(program.start())(owned.problem.fixed_variables), owned.problem.fixed_values);
  Problem other = owned.problem;
  other.topology = new_topology();
  EXPECT_FALSE(program.fits(other));
  other.topology = 0;
  EXPECT_FALSE(program.fits(other));
}

TEST(SpectralBox, WithEqualLimitsHasOneEquationPerCoordinate) {
  const SpectralBox box(2, 2);
  ASSERT_EQ(box.smooth_rows(), 3);
  Vector3 lower, upper, g;
  box.smooth_bounds(lower.data(), upper.data());
  EXPECT_EQ(lower, upper);
  box.smooth_values(0, Vector3(2, 0, 2).eval().data(), g.data(), nullptr);
  EXPECT_EQ(g, lower);
}

}  // namespace
}  // namespace taut
