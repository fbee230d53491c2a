#include "energies/prism_mass.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "energies/prism_quadrature.h"
#include "geometry/layered_mesh.h"
#include "support/meshes.h"
#include "support/random_values.h"
#include "support/shells.h"

namespace taut {
namespace {

/// dX/dq of MLTS (2), for an oracle that shares nothing with the closed form.
Matrix3 map_derivative(const PrismShape& s, double l1, double l2, double gamma) {
  Matrix3 d;
  d.col(0) = s.mid.col(1) - s.mid.col(0) + gamma * (s.director.col(1) - s.director.col(0));
  d.col(1) = s.mid.col(2) - s.mid.col(0) + gamma * (s.director.col(2) - s.director.col(0));
  d.col(2) = (1 - l1 - l2) * s.director.col(0) + l1 * s.director.col(1) + l2 * s.director.col(2);
  return d;
}

/// MLTS (10) by a product rule with Gauss points in the collapsed square: exact for the polynomials of degree 3 in L
/// and 4 in gamma that occur.
PrismMass integrated(const PrismShape& shape, double density) {
  PrismMass mass = PrismMass::Zero();
  for (const LinePoint& u : gauss_rule(4)) {
    for (const LinePoint& v : gauss_rule(4)) {
      for (const LinePoint& w : gauss_rule(4)) {
        const double l1 = 0.5 * (1 + u.gamma), l2 = 0.5 * (1 + v.gamma) * (1 - l1), gamma = w.gamma;
        const double weight = 0.25 * u.weight * v.weight * (1 - l1) * w.weight;
        Eigen::Matrix<double, 6, 1> n;
        n << 1 - l1 - l2, l1, l2, gamma * (1 - l1 - l2), gamma * l1, gamma * l2;
        mass += density * weight * map_derivative(shape, l1, l2, gamma).determinant() * n * n.transpose();
      }
    }
  }
  return mass;
}

TEST(PrismMass, OnRandomCurvedPrismsIsTheIntegral) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const PrismShape shape(random_prism(seed, 0.5));
    const PrismMass mass = director_mass(shape, 3.0);
    EXPECT_LE((mass - integrated(shape, 3.0)).cwiseAbs().maxCoeff(), 1e-14 * mass.maxCoeff()) << seed;
  }
}

TEST(PrismMass, OfPositionsSumsToDensityTimesVolume) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const PrismShape shape(random_prism(seed, 0.5));
    const double volume = PrismJacobian(shape).volume();
    EXPECT_NEAR((director_mass(shape, 3.0).topLeftCorner<3, 3>().sum()), 3.0 * volume, 1e-14);
    EXPECT_NEAR(surface_mass(shape, 3.0).sum(), 3.0 * volume, 1e-14);
  }
}

TEST(PrismMass, PutsMoreOnTheOuterSurfaceOfACylinder) {
  // Radius 2, thickness 0.4: outer and inner nodes carry unequal mass, which a wrong sign of the coupling block swaps.
  std::array<Vector3, 6> points;
  const double angles[3] = {0, 0.3, 0.15}, heights[3] = {0, 0, 0.5};
  for (int j = 0; j < 3; ++j) {
    const Vector3 out(std::cos(angles[j]), std::sin(angles[j]), 0), z(0, 0, heights[j]);
    points[2 * j] = 1.8 * out + z;
    points[2 * j + 1] = 2.2 * out + z;
  }
  const PrismMass mass = surface_mass(PrismShape(points), 1.0);
  for (int j = 0; j < 3; ++j) EXPECT_GT(mass.row(2 * j + 1).sum(), 1.03 * mass.row(2 * j).sum());
}

TEST(PrismMass, IsPositiveDefiniteOnUprightPrisms) {
  int upright = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const PrismShape shape(random_prism(seed, 1.5));
    if (!(PrismJacobian(shape).smallest() > 0)) continue;
    ++upright;
    const PrismMass mass = surface_mass(shape, 1.0);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<PrismMass>(mass).eigenvalues()[0], 0) << seed;
    for (int j = 0; j < 6; ++j) EXPECT_GT(mass.row(j).sum(), 0) << seed;
  }
  EXPECT_GT(upright, 50);
}

TEST(PrismJacobian, SmallestIsTheMinimumOfTheDeterminant) {
  int inverted = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const PrismShape shape(random_prism(seed, 2.5));
    const double smallest = PrismJacobian(shape).smallest();
    double sampled = 1e300;
    const double corners[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    for (const auto& l : corners) {
      for (int i = 0; i <= 2000; ++i) {
        sampled = std::min(sampled, map_derivative(shape, l[0], l[1], 1e-3 * i - 1).determinant());
      }
    }
    EXPECT_LE(smallest, sampled + 1e-15) << seed;
    EXPECT_NEAR(smallest, sampled, 1e-6) << seed;
    inverted += sampled < 0;
  }
  EXPECT_GT(inverted, 20);
  EXPECT_LT(inverted, 180);
}

TEST(PrismJacobian, OfSwappedVerticesIsNegative) {
  auto points = random_prism(1, 0.2);
  std::swap(points[0], points[2]);
  std::swap(points[1], points[3]);
  EXPECT_LT(PrismJacobian(PrismShape(points)).volume(), 0);
}

TEST(PrismInertia, GivesTheWeightOfTheSolidAsGravity) {
  TriangleMesh mesh = make_grid(2, 1, 4, 2, Diagonals::alternating);
  for (Vector3& v : mesh.vertices) v = rolled(v, 0.7);
  const LayeredMesh layered = make_layered(mesh, std::vector{0.2}, {0.5, 0.5}, "roof");
  double volume = 0;
  for (const Prism& prism : layered.prisms) {
    std::array<Vector3, 6> points;
    for (int j = 0; j < 6; ++j) points[j] = layered.nodes[prism[j]];
    volume += PrismJacobian(PrismShape(points)).volume();
  }
  const Vector g = Vector3(0, 0, -9.81).replicate(static_cast<Index>(layered.nodes.size()), 1);
  Vector consistent = Vector::Zero(g.size()), lumped = consistent;
  consistent_prism_inertia("c", layered.prisms, layered.nodes, 7.0).add_product(g, consistent);
  lumped_prism_inertia("l", layered.prisms, layered.nodes, 7.0).add_product(g, lumped);
  EXPECT_NEAR(consistent.sum(), -9.81 * 7.0 * volume, 1e-12);
  EXPECT_LE((consistent - lumped).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(PrismInertia, RefusesInvertedPrisms) {
  auto points = random_prism(1, 0.2);
  std::swap(points[0], points[1]);
  const std::vector<Vector3> nodes(points.begin(), points.end());
  EXPECT_THROW(consistent_prism_inertia("c", {{0, 1, 2, 3, 4, 5}}, nodes, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace taut
