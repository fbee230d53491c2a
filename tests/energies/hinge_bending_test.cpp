#include "energies/hinge_bending.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/assembly.h"
#include "support/meshes.h"
#include "support/random_values.h"

namespace taut {
namespace {

constexpr double stiffness = 0.7;

double energy(const HingeBending& bending, const std::vector<Vector3>& positions) {
  const Vector x = flatten(positions);
  return Assembly(x.size(), {&bending}, {}, 1).value(x);
}

TEST(HingeAngle, IsTheFoldAngleWithItsSign) {
  for (double angle : {-3.0, -1.0, -1e-9, 0.0, 1e-9, 0.5, 1.5, 3.1}) {
    // Edge along x; the left wing lies in y > 0, the right one is folded up by `angle` about the edge.
    Eigen::Matrix<double, 12, 1> x;
    x << 0, 0, 0, 2, 0, 0, 0.3, 1, 0, 1.1, -0.5 * std::cos(angle), 0.5 * std::sin(angle);
    EXPECT_NEAR(std::abs(hinge_angle(x.data())), std::abs(angle), 1e-15);
    Eigen::Matrix<double, 12, 1> mirrored = x;
    for (int i = 2; i < 12; i += 3) mirrored[i] *= -1;
    EXPECT_EQ(hinge_angle(mirrored.data()), -hinge_angle(x.data()));
  }
}

TEST(HingeBending, HasOneHingeForEachInnerEdge) {
  // 3 x 2 cells: 17 grid edges and 6 diagonals, less 10 on the boundary.
  const TriangleMesh mesh = make_grid(3, 2, 3, 2, Diagonals::alternating);
  EXPECT_EQ(make_hinges(mesh.triangles, mesh.vertices, 1, true).size(), 13u);
  EXPECT_EQ(make_hinges(octahedron().triangles, octahedron().vertices, 1, true).size(), 12u);
}

TEST(HingeBending, HasTheStiffnessOfItsFormulaAndShiftedVertices) {
  const TriangleMesh mesh = make_grid(2, 3, 1, 1, Diagonals::right);
  const std::vector<Hinge> hinges = make_hinges(mesh.triangles, mesh.vertices, stiffness, true, 10);
  ASSERT_EQ(hinges.size(), 1u);
  EXPECT_DOUBLE_EQ(hinges[0].stiffness, 3 * stiffness * 13 / 6);
  for (int vertex : hinges[0].vertices) EXPECT_GE(vertex, 10);
  EXPECT_EQ(hinges[0].rest_angle, 0);
}

TEST(HingeBending, FromCornersInThePlaneIsThatFromAFlatRestShape) {
  const TriangleMesh mesh = make_grid(2, 3, 3, 4, Diagonals::alternating);
  const std::vector<Hinge> flat = make_hinges(mesh.triangles, mesh.vertices, stiffness, true, 5);
  const std::vector<Hinge> corners = make_hinges(mesh.triangles, mesh.corner_uv, stiffness, 5);
  ASSERT_EQ(corners.size(), flat.size());
  for (std::size_t i = 0; i < flat.size(); ++i) {
    EXPECT_EQ(corners[i].vertices, flat[i].vertices);
    EXPECT_NEAR(corners[i].stiffness, flat[i].stiffness, 1e-12);
    EXPECT_EQ(corners[i].rest_angle, 0);
  }
}

TEST(HingeBending, VanishesAtItsRestShapeFlatOrCurved) {
  const TriangleMesh mesh = make_grid(2, 2, 5, 5, Diagonals::alternating);
  const std::vector<Vector3> curved = mapped(mesh.vertices, [](const Vector3& v) { return rolled(v, 0.8); });
  const HingeBending keeps("bending", make_hinges(mesh.triangles, curved, stiffness, false));
  const HingeBending flat("bending", make_hinges(mesh.triangles, curved, stiffness, true));
  EXPECT_NEAR(energy(keeps, curved), 0, 1e-25);
  EXPECT_GT(energy(keeps, mesh.vertices), 1e-2);
  EXPECT_GT(energy(flat, curved), 1e-2);
  EXPECT_NEAR(energy(flat, mesh.vertices), 0, 1e-25);
}

TEST(HingeBending, OfASheetRolledAlongItsGridIsThreeTimesAPlates) {
  // Only edges along the axis bend, each by exactly kappa h: the sum is 3 x D/2 kappa^2 times the area, less half a
  // column at either end.
  const double kappa = 0.6, size = 2;
  for (int cells : {4, 16}) {
    for (Diagonals diagonals : {Diagonals::right, Diagonals::alternating}) {
      const TriangleMesh mesh = make_grid(size, size, cells, cells, diagonals);
      const HingeBending bending("bending", make_hinges(mesh.triangles, mesh.vertices, stiffness, true));
      const double plate = 0.5 * stiffness * kappa * kappa * size * size * (cells - 1) / cells;
      EXPECT_NEAR(energy(bending, mapped(mesh.vertices, [&](const Vector3& v) { return rolled(v, kappa); })), 3 * plate,
                  1e-11);
    }
  }
}

TEST(HingeBending, OfADomedEquilateralSheetConvergesToThePlates) {
  // D/2 (kappa1 + kappa2)^2 times the area, of which each hinge stands for a third of its two triangles; flat domes, so
  // that bending stays linear.
  const double kappa = 1e-4;
  for (int cells : {6, 12}) {
    TriangleMesh mesh = make_grid(cells, cells, cells, cells, Diagonals::left);
    for (Vector3& v : mesh.vertices) v = {v.x() + 0.5 * v.y(), std::numbers::sqrt3 / 2 * v.y(), 0};
    const std::vector<Hinge> hinges = make_hinges(mesh.triangles, mesh.vertices, stiffness, true);
    const double covered = static_cast<double>(hinges.size()) * std::numbers::sqrt3 / 2 / 3;
    const HingeBending bending("bending", hinges);
    const std::vector<Vector3> dome = mapped(mesh.vertices, [&](const Vector3& v) {
      return Vector3(v.x(), v.y(), 0.5 * kappa * (v - Vector3(0.75 * cells, 0.43 * cells, 0)).squaredNorm());
    });
    const double plate = 0.5 * stiffness * 4 * kappa * kappa * covered;
    EXPECT_NEAR(energy(bending, dome), plate, 1e-5 * plate);
  }
}

TEST(HingeBending, IsFiniteWithItsDerivativesInAFlatState) {
  const TriangleMesh mesh = make_grid(1, 1, 2, 2, Diagonals::left);
  const HingeBending bending("bending", make_hinges(mesh.triangles, mesh.vertices, stiffness, true));
  const Vector x = flatten(mesh.vertices);
  Assembly assembly(x.size(), {&bending}, {}, 1);
  assembly.hessian(x, Curvature::exact);
  EXPECT_TRUE(Matrix(assembly.matrix()).allFinite());
}

}  // namespace
}  // namespace taut
