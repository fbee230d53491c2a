#include "solvers/equality_system.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "energies/dead_load.h"
#include "energies/membrane.h"
#include "solvers/augmented_lagrangian.h"
#include "solvers/curvature.h"
#include "solvers/null_space_system.h"
#include "support/meshes.h"
#include "support/problems.h"
#include "support/random_values.h"

namespace taut {
namespace {

/// 1/2 sum_i k_i x_i^2, of either sign.
class Diagonal final : public Energy {
 public:
  explicit Diagonal(Vector k) : k_(std::move(k)) {
    for (int i = 0; i < static_cast<int>(k_.size()); ++i) stencils_.add(std::array{i});
  }
  std::string name() const override { return "diagonal"; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian, Curvature) const override {
    if (gradient) *gradient = k_[element] * *x;
    if (hessian) *hessian = k_[element];
    return 0.5 * k_[element] * *x * *x;
  }

 private:
  Vector k_;
  Stencils stencils_{1};
};

/// A sheet with inertia and a membrane under random loads, held at a corner, with rows that touch every vertex.
struct CoupledSheet {
  TriangleMesh mesh = make_grid(1, 1, 5, 5, Diagonals::alternating);
  std::vector<RestTriangle> triangles = rest_triangles(mesh.triangles, mesh.vertices);
  OwnedProblem owned;
  LinearEqualities equal;

  explicit CoupledSheet(bool dependent_row = false) {
    Problem& problem = owned.problem;
    problem.initial_guess = flatten(mesh.vertices) + 0.02 * RandomValues(3).vector(108);
    owned.pin({0});
    auto inertia = std::make_shared<Inertia>(Inertia::lumped("inertia", triangles, 0.2, 36));
    inertia->set_target(1e3, flatten(mesh.vertices));
    owned.add(std::shared_ptr<const Energy>(inertia));
    owned.add(std::make_shared<Membrane>("membrane", triangles, MembraneLaw::stvk, Lame::plane_stress(100, 0.3), 1.0));
    owned.add(std::make_shared<DeadLoad>("load", RandomValues(5).vector(108)));
    Matrix rows = RandomValues(6).matrix(4, 108) / 50;
    if (dependent_row) rows.row(3) = rows.row(0) - 2 * rows.row(1);
    equal.name = "rows";
    equal.rows = rows.sparseView();
    equal.values = 0.01 * RandomValues(7).vector(4);
    if (dependent_row) equal.values[3] = equal.values[0] - 2 * equal.values[1];
    equal.row_name = [](Index row) { return "row " + std::to_string(row); };
    problem.equalities = {&equal};
    problem.topology = new_topology();
  }
};

AugmentedLagrangianOptions options_of(const std::string& kind) {
  AugmentedLagrangianOptions options;
  options.tolerances = {1e-11, 1e-13, 1e-10};
  options.null_space = kind == "null_space" || kind == "conjugate_gradients";
  options.conjugate_gradients = kind == "conjugate_gradients";
  if (kind == "penalised") options.equalities = EqualityForm::penalised;
  return options;
}

class EverySystem : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<NewtonSystem> system(Assembly& assembly, const EqualityRows& equalities, const Problem& problem) {
    if (GetParam() == "null_space") return std::make_unique<NullSpaceSystem>(assembly, equalities, problem);
    if (GetParam() == "penalised")
      return std::make_unique<PenalisedRowsSystem>(assembly, equalities, problem.fixed_variables, 1);
    return std::make_unique<QuasiDefiniteSystem>(assembly, equalities, problem.fixed_variables);
  }
};

TEST_P(EverySystem, SolvesItsEquationsToRoundOff) {
  const CoupledSheet sheet;
  const Problem& problem = sheet.owned.problem;
  const EqualityRows equalities(problem);
  Assembly assembly(problem.size(), problem.energies,
                    GetParam() == "null_space" ? std::vector<int>{} : problem.fixed_variables, 1);
  const auto newton = system(assembly, equalities, problem);
  Vector gradient, violation, step, multipliers;
  assembly.hessian(problem.initial_guess, Curvature::positive_semidefinite, &gradient);
  for (const int v : problem.fixed_variables) gradient[v] = 0;
  equalities.violation(problem.initial_guess, violation);
  ASSERT_TRUE(newton->factorize(0));
  newton->solve(gradient, violation, step, multipliers);
  for (const int v : problem.fixed_variables) EXPECT_EQ(step[v], 0);
  EXPECT_LE((equalities.rows() * step + violation).lpNorm<Eigen::Infinity>(), 1e-15);
  Vector ordered, full;
  assembly.to_ordered(step, ordered);
  assembly.from_ordered(assembly.matrix().selfadjointView<Eigen::Lower>() * ordered, full);
  full += gradient + equalities.rows().transpose() * multipliers;
  for (const int v : problem.fixed_variables) full[v] = 0;
  EXPECT_LE(full.norm(), 1e-11 * gradient.norm());
}

TEST_P(EverySystem, SeesCurvatureWhereTheEqualitiesLeaveRoomOnly) {
  // x_0 + x_1 + x_2 = 0; the curvature along (1, 1, 1) may be negative, across it not.
  for (const double along : {-0.5, -1.5}) {
    // diag(2, 2, along) is positive definite on the plane iff 1/2 + 1/2 + 1/along < 0, or along > 0: along > -1.
    const auto energy = std::make_shared<Diagonal>(Vector3(2, 2, along));
    OwnedProblem owned;
    owned.problem.initial_guess = Vector::Zero(3);
    owned.problem.node_size = 1;
    owned.add(std::shared_ptr<const Energy>(energy));
    LinearEqualities equal;
    equal.rows = Matrix::Ones(1, 3).sparseView();
    equal.values = Vector::Zero(1);
    owned.problem.equalities = {&equal};
    const EqualityRows equalities(owned.problem);
    Assembly assembly(3, owned.problem.energies, {}, 1);
    const auto newton = system(assembly, equalities, owned.problem);
    assembly.hessian(owned.problem.initial_guess, Curvature::exact);
    EXPECT_EQ(newton->factorize(0), along > -1) << along;
  }
}

TEST_P(EverySystem, ReachesTheSameMinimumWithTheSameMultipliers) {
  const CoupledSheet sheet;
  AugmentedLagrangian reference(options_of("quasi_definite")), solver(options_of(GetParam()));
  const Result expected = reference.solve(sheet.owned.problem, {}, {}),
               found = solver.solve(sheet.owned.problem, {}, {});
  EXPECT_EQ(found.status, Status::solved) << found.message;
  EXPECT_LE((found.x - expected.x).norm(), 1e-9);
  ASSERT_EQ(found.multipliers.size(), 1u);
  EXPECT_LE((found.multipliers[0] - expected.multipliers[0]).norm(), 1e-8 * expected.multipliers[0].norm());
  const Residuals judged = residuals(sheet.owned.problem, found);
  EXPECT_LE(judged.violations[0].max, 1e-15);
  EXPECT_EQ(judged.violations[0].constraint, "rows");
}

TEST_P(EverySystem, BearsDependentRowsThatAreCompatible) {
  const CoupledSheet sheet(true);
  AugmentedLagrangian solver(options_of(GetParam()));
  const Result found = solver.solve(sheet.owned.problem, {}, {});
  EXPECT_EQ(found.status, Status::solved) << found.message;
}

TEST_P(EverySystem, DoesNotCallContradictingRowsSolved) {
  CoupledSheet sheet(true);
  sheet.equal.values[3] += 0.1;
  AugmentedLagrangianOptions options = options_of(GetParam());
  options.max_newton = 60;
  AugmentedLagrangian solver(options);
  EXPECT_NE(solver.solve(sheet.owned.problem, {}, {}).status, Status::solved);
}

TEST_P(EverySystem, WorksUnderAStrainLimit) {
  CoupledSheet sheet;
  sheet.owned.add(std::make_shared<MatrixStrainLimit>(limit_on(sheet.triangles, 0, 1.001)));
  AugmentedLagrangianOptions options = options_of(GetParam());
  options.tolerances = {1e-8, 1e-9, 1e-8};
  options.central_path.enabled = false;
  AugmentedLagrangian loop(options);
  options.central_path.enabled = true;
  AugmentedLagrangian path(options);
  const Result found = loop.solve(sheet.owned.problem, {}, {}), along = path.solve(sheet.owned.problem, {}, {});
  EXPECT_EQ(found.status, Status::solved) << found.message;
  EXPECT_EQ(along.status, Status::solved) << along.message;
  EXPECT_LE((found.x - along.x).norm(), 1e-6);
  EXPECT_GT(found.multipliers[0].norm(), 0);  // the limit is active
}

INSTANTIATE_TEST_SUITE_P(Kinds, EverySystem, testing::Values("quasi_definite", "penalised", "null_space"),
                         [](const auto& instance) { return instance.param; });

TEST(ConjugateGradients, ReachTheMinimumOfTheFactorisedNullSpace) {
  const CoupledSheet sheet;
  AugmentedLagrangian reference(options_of("null_space")), solver(options_of("conjugate_gradients"));
  const Result expected = reference.solve(sheet.owned.problem, {}, {}),
               found = solver.solve(sheet.owned.problem, {}, {});
  EXPECT_EQ(found.status, Status::solved) << found.message;
  EXPECT_LE((found.x - expected.x).norm(), 1e-9);
  EXPECT_LE((found.multipliers[0] - expected.multipliers[0]).norm(), 1e-7 * expected.multipliers[0].norm());
}

TEST(NegativeCurvatures, AreCountedOnThePlaneThatTheEqualitiesLeave) {
  // As above: diag(2, 2, along) on x_0 + x_1 + x_2 = 0.
  for (const auto& [along, expected] : {std::pair(-0.5, 0), {-1.5, 1}}) {
    OwnedProblem owned;
    owned.problem.initial_guess = Vector::Zero(3);
    owned.problem.node_size = 1;
    owned.add(std::shared_ptr<const Energy>(std::make_shared<Diagonal>(Vector3(2, 2, along))));
    LinearEqualities equal;
    equal.rows = Matrix::Ones(1, 3).sparseView();
    equal.values = Vector::Zero(1);
    owned.problem.equalities = {&equal};
    Result result;
    result.x = Vector::Zero(3);
    result.multipliers = {Vector::Zero(1)};
    EXPECT_EQ(negative_curvatures(owned.problem, result, {}), expected) << along;
  }
}

TEST(EqualityRows, PutMultipliersBehindThoseOfConstraintsAndTakeThemBack) {
  const CoupledSheet sheet;
  const EqualityRows rows(sheet.owned.problem);
  std::vector<Vector> multipliers{Vector::Ones(7)};
  const Vector own = RandomValues(2).vector(4);
  rows.put(own, 1, multipliers);
  ASSERT_EQ(multipliers.size(), 2u);
  EXPECT_EQ(rows.stacked(multipliers, 1), own);
  EXPECT_EQ(rows.stacked({}, 1), Vector::Zero(4));
}

}  // namespace
}  // namespace taut
