#include "solvers/preconditioned_system.h"

#include <gtest/gtest.h>

#include <memory>

#include "energies/hinge_bending.h"
#include "energies/membrane.h"
#include "support/meshes.h"
#include "support/problems.h"
#include "support/random_values.h"

namespace taut {
namespace {

/// A crumpled sheet of 10 x 10 cells, held at a corner: inertia of 3e-3 N/m at a vertex, a membrane, and bending.
struct CrumpledSheet {
  static constexpr int vertices = 121;
  TriangleMesh mesh = make_grid(1, 1, 10, 10, Diagonals::alternating);
  std::vector<RestTriangle> triangles = rest_triangles(mesh.triangles, mesh.vertices);
  Inertia inertia = Inertia::lumped("inertia", triangles, 0.3, vertices);
  Membrane membrane{"membrane", triangles, MembraneLaw::stvk, Lame::plane_stress(100, 0.3), 1.0};
  HingeBending bending;
  Vector x = flatten(mesh.vertices) + 0.02 * RandomValues(3).vector(3 * vertices);
  Assembly assembly;
  std::vector<int> order = fill_reducing_order(assembly.graph());
  std::unique_ptr<Cholesky> cholesky;
  Vector gradient, step, none;

  explicit CrumpledSheet(double bending_stiffness)
      : bending("bending", make_hinges(mesh.triangles, mesh.vertices, bending_stiffness, false)),
        assembly(3 * vertices, {&inertia, &membrane, &bending}, {0, 1, 2}, 1) {
    inertia.set_target(1, flatten(mesh.vertices));
    assembly.set_order(order);
    cholesky = std::make_unique<Cholesky>(assembly.matrix(), 1);
  }
  Vector direct_step() {
    SubstitutedSystem direct(assembly, *cholesky);
    EXPECT_TRUE(direct.factorize(0));
    EXPECT_TRUE(direct.solve(gradient, {}, step, none));
    return step;
  }
};

/// |v| in the energy of the matrix.
double energy_norm(const CrumpledSheet& sheet, const Vector& v) {
  Vector ordered;
  sheet.assembly.to_ordered(v, ordered);
  return std::sqrt(ordered.dot(sheet.assembly.matrix().selfadjointView<Eigen::Lower>() * ordered));
}

TEST(PreconditionedSystem, LeavesBendingsOwnCouplingsOutOfTheFactor) {
  CrumpledSheet sheet(1e-6);
  // 320 edges, of which the held corner has three; bending alone couples the vertices across them.
  EXPECT_EQ(sheet.assembly.strong_graph().neighbours.size(), 2u * (320 - 3));
  const PreconditionedSystem system(sheet.assembly, sheet.order, *sheet.cholesky, 1);
  EXPECT_LT(system.size().factor_flops, 0.5 * sheet.cholesky->factor_flops());
}

TEST(Assembly, HoldsWhatBendingAddedBefore) {
  CrumpledSheet sheet(1e-3), before(1e-3);
  const auto semidefinite = Curvature::positive_semidefinite;
  const Vector moved = sheet.x + 0.02 * RandomValues(4).vector(sheet.x.size());
  before.assembly.hessian(moved, semidefinite);
  const SparseMatrix anew = before.assembly.matrix();
  sheet.assembly.hessian(sheet.x, semidefinite);
  const SparseMatrix start = sheet.assembly.matrix();
  Vector gradient, expected;
  sheet.assembly.hessian(sheet.x, semidefinite, &gradient, true);
  EXPECT_EQ((SparseMatrix(sheet.assembly.matrix() - start)).norm(), 0);
  sheet.assembly.hessian(moved, semidefinite, &gradient, true);
  before.assembly.gradient(moved, expected);
  EXPECT_EQ((gradient - expected).norm(), 0);  // forces are of now
  // The difference to the matrix of now is bending's alone.
  Assembly bending(sheet.x.size(), {&sheet.bending}, {0, 1, 2}, 1);
  const auto norm_of_bending = [&](const Vector& x) {
    bending.hessian(x, semidefinite);
    return bending.matrix().norm();
  };
  const double difference = SparseMatrix(sheet.assembly.matrix() - anew).norm();
  EXPECT_GT(difference, 0);
  EXPECT_LE(difference, norm_of_bending(sheet.x) + norm_of_bending(moved));
  EXPECT_LT(difference, 0.1 * anew.norm());
}

TEST(PreconditionedSystem, AFewIterationsGiveTheStepOfTheWholeMatrix) {
  CrumpledSheet sheet(1e-6);
  for (const int threads : {1, 2}) {
    PreconditionedSystem system(sheet.assembly, sheet.order, *sheet.cholesky, threads);
    for (const double shift : {0.0, 1e-3}) {
      sheet.assembly.hessian(sheet.x, Curvature::positive_semidefinite, &sheet.gradient);
      ASSERT_TRUE(sheet.cholesky->factorize(sheet.assembly.matrix(), shift));
      Vector ordered, solution, direct;
      sheet.assembly.to_ordered(sheet.gradient, ordered);
      sheet.cholesky->solve(ordered, solution);
      sheet.assembly.from_ordered(solution, direct);
      system.allow(1e-6 * sheet.gradient.norm());
      ASSERT_TRUE(system.factorize(shift));
      ASSERT_TRUE(system.solve(sheet.gradient, {}, sheet.step, sheet.none));
      EXPECT_LT(energy_norm(sheet, sheet.step + direct), 1e-4 * energy_norm(sheet, direct)) << shift;
    }
    EXPECT_GT(system.effort().iterations, 2);
    EXPECT_LT(system.effort().iterations, 20) << "two systems";
    EXPECT_EQ(system.effort().refactorized, 0);
  }
}

/// The whole matrix is factorised where the iteration would be long, at once from then on, until the next start.
TEST(PreconditionedSystem, StiffBendingIsFactorised) {
  CrumpledSheet sheet(1.0);
  PreconditionedSystem system(sheet.assembly, sheet.order, *sheet.cholesky, 1);
  sheet.assembly.hessian(sheet.x, Curvature::positive_semidefinite, &sheet.gradient);
  system.allow(1e-6 * sheet.gradient.norm());
  const Vector direct = sheet.direct_step();
  for (const int refactorized : {1, 1}) {
    ASSERT_TRUE(system.factorize(0));
    ASSERT_TRUE(system.solve(sheet.gradient, {}, sheet.step, sheet.none));
    EXPECT_LT((sheet.step - direct).norm(), 1e-12 * direct.norm());
    EXPECT_EQ(system.effort().refactorized, refactorized);
  }
  const double each = sheet.cholesky->factor_flops() - system.size().factor_flops;
  EXPECT_DOUBLE_EQ(system.effort().more_flops, 2 * each);
  system.start();
  ASSERT_TRUE(system.factorize(0));
  ASSERT_TRUE(system.solve(sheet.gradient, {}, sheet.step, sheet.none));
  EXPECT_EQ(system.effort().refactorized, 2);
}

/// A squeezed membrane, whose exact Hessian is indefinite.
TEST(PreconditionedSystem, FactorisesTheWholeMatrixWhereNothingIsAllowed) {
  CrumpledSheet sheet(1e-6);
  PreconditionedSystem system(sheet.assembly, sheet.order, *sheet.cholesky, 1);
  sheet.assembly.hessian(0.5 * sheet.x, Curvature::exact, &sheet.gradient);
  ASSERT_FALSE(sheet.cholesky->factorize(sheet.assembly.matrix()));
  EXPECT_FALSE(system.factorize(0));
  sheet.assembly.hessian(sheet.x, Curvature::positive_semidefinite, &sheet.gradient);
  const Vector direct = sheet.direct_step();
  ASSERT_TRUE(system.factorize(0));
  ASSERT_TRUE(system.solve(sheet.gradient, {}, sheet.step, sheet.none));
  EXPECT_EQ(sheet.step, direct);
  EXPECT_EQ(system.effort().iterations, 0);
}

}  // namespace
}  // namespace taut
