#include <gtest/gtest.h>

#include <cmath>

#include "core/assembly.h"
#include "energies/dead_load.h"
#include "energies/inertia.h"
#include "energies/pressure.h"
#include "energies/wind.h"
#include "support/meshes.h"
#include "support/random_values.h"
#include "support/specimens.h"

namespace taut {
namespace {

Vector gradient_of(const Energy& energy, const Vector& x) {
  Vector gradient;
  Assembly(x.size(), {&energy}, {}, 1).gradient(x, gradient);
  return gradient;
}

Vector3 sum_over_vertices(const Vector& v) {
  Vector3 sum = Vector3::Zero();
  for (Index i = 0; i < v.size(); i += 3) sum += v.segment<3>(i);
  return sum;
}

TEST(Inertia, MassesSumToDensityTimesArea) {
  const TriangleMesh mesh = make_grid(2, 3, 3, 4, Diagonals::alternating);
  const std::vector<RestTriangle> triangles = rest_triangles(mesh.triangles, mesh.vertices);
  const Index vertices = static_cast<Index>(mesh.vertices.size());
  for (const Inertia& inertia :
       {Inertia::lumped("m", triangles, 0.2, vertices), Inertia::consistent("m", triangles, 0.2)}) {
    Vector momentum = Vector::Zero(3 * vertices), velocity = momentum;
    for (Index i = 0; i < velocity.size(); i += 3) velocity.segment<3>(i) = Vector3(1, -2, 2);
    inertia.add_product(velocity, momentum);
    EXPECT_LE((sum_over_vertices(momentum) - 0.2 * 6 * Vector3(1, -2, 2)).norm(), 1e-13);
    EXPECT_NEAR(inertia.kinetic_energy(velocity), 0.5 * 0.2 * 6 * 9, 1e-12);
  }
}

TEST(Inertia, ConsistentMassIntegratesLinearVelocitiesExactly) {
  // Over [0, 2] x [0, 3]: integral of (x + 2 y)^2 = 8 + 36 + 72 = 116.
  const TriangleMesh mesh = make_grid(2, 3, 2, 3, Diagonals::left);
  const Inertia inertia = Inertia::consistent("m", rest_triangles(mesh.triangles, mesh.vertices), 0.5);
  const Vector velocity =
      flatten(mapped(mesh.vertices, [](const Vector3& v) { return Vector3(0, v.x() + 2 * v.y(), 0); }));
  const double expected = 8.0 + 36.0 + 72.0;
  EXPECT_NEAR(inertia.kinetic_energy(velocity), 0.5 * 0.5 * expected, 1e-12);
}

TEST(Inertia, PullsTowardsItsTarget) {
  const TriangleMesh mesh = make_grid(2, 3, 1, 1, Diagonals::left);
  Inertia inertia = Inertia::lumped("m", rest_triangles(mesh.triangles, mesh.vertices), 0.5, 4);
  const Vector target = RandomValues(1).vector(12), x = RandomValues(2).vector(12);
  inertia.set_target(25.0, target);
  Vector expected = Vector::Zero(12);
  inertia.add_product(25.0 * (x - target), expected);
  EXPECT_LE((gradient_of(inertia, x) - expected).norm(), 1e-13);
  EXPECT_EQ(gradient_of(inertia, target), Vector::Zero(12));
}

TEST(DeadLoad, IsMinusForceTimesPositionScaledByItsFactor) {
  const Vector force = RandomValues(1).vector(9), x = RandomValues(2).vector(9);
  DeadLoad load("load", force);
  load.set_factor(0.25);
  EXPECT_EQ(gradient_of(load, x), -0.25 * force);
  EXPECT_NEAR(Assembly(9, {&load}, {}, 1).value(x), -0.25 * force.dot(x), 1e-15);
}

TEST(DeadLoad, LeavesOutVerticesWithoutForceUnlessAskedToKeepThem) {
  Vector force = Vector::Zero(9);
  force[4] = 1;
  EXPECT_EQ(DeadLoad("load", force).stencils().count(), 1);
  DeadLoad all("load", force, true);
  EXPECT_EQ(all.stencils().count(), 3);
  all.set_forces(Vector::Ones(9));
  EXPECT_EQ(gradient_of(all, Vector::Zero(9)), -Vector::Ones(9));
  EXPECT_THROW(all.set_forces(Vector::Ones(6)), std::invalid_argument);
}

TEST(Pressure, OnAClosedSurfaceHasNoNetForceAndIsMinusPressureTimesVolume) {
  RandomValues random(1);
  TriangleMesh mesh = octahedron();
  const Pressure pressure("p", mesh.triangles, 3.0);
  EXPECT_NEAR(Assembly(18, {&pressure}, {}, 1).value(flatten(mesh.vertices)), -3.0 * 4.0 / 3, 1e-14);
  for (Vector3& v : mesh.vertices)
    v += 0.2 * Vector3(random.value(), random.value(), random.value()) + Vector3(5, 0, 0);
  const Vector gradient = gradient_of(pressure, flatten(mesh.vertices));
  EXPECT_LE(sum_over_vertices(gradient).norm(), 1e-13);
  EXPECT_GT(gradient.norm(), 1);
}

TEST(Pressure, OnAPlaneIsPressureTimesAreaAlongItsNormal) {
  const TriangleMesh mesh = make_grid(2, 3, 4, 4, Diagonals::alternating);
  Pressure pressure("p", mesh.triangles, 3.0);
  pressure.set_factor(0.5);
  const Vector force = -gradient_of(
      pressure, flatten(mapped(mesh.vertices, [](const Vector3& v) { return Vector3(v.x() + 7, v.y(), 4); })));
  Vector area = Vector::Zero(static_cast<Index>(mesh.vertices.size()));
  for (const Triangle& triangle : mesh.triangles) {
    for (int vertex : triangle) area[vertex] += 2.0 / 4 * 3.0 / 4 / 2 / 3;
  }
  // Boundary vertices also carry the cone from the origin: there the potential is one of pressure only where they are
  // held.
  for (int j = 1; j < 4; ++j) {
    for (int i = 1; i < 4; ++i) {
      const int vertex = j * 5 + i;
      EXPECT_LE((force.segment<3>(3 * vertex) - Vector3(0, 0, 0.5 * 3 * area[vertex])).norm(), 1e-13);
    }
  }
}

TEST(Wind, IsTheDragOfAPlateAcrossIt) {
  const TriangleMesh mesh = make_grid(2, 3, 2, 2, Diagonals::left);
  const Vector x = flatten(mesh.vertices), still = Vector::Zero(x.size());
  Wind wind;
  wind.velocity = {3, 0, -4};
  wind.air_density = 1.2;
  wind.drag = 1.5;
  Vector force = still;
  add_wind(wind, mesh.triangles, 0, x, still, force);
  EXPECT_LE((sum_over_vertices(force) - Vector3(0, 0, -0.5 * 1.2 * 1.5 * 6 * 16)).norm(), 1e-12);
}

TEST(Wind, IsFeltRelativeToTheClothAndNotAlongIt) {
  const TriangleMesh mesh = make_grid(2, 3, 2, 2, Diagonals::left);
  const Vector x = flatten(mesh.vertices);
  Wind wind;
  wind.velocity = {3, 0, -4};
  const auto moving = [&](const Vector3& velocity) {
    Vector v(x.size()), force = Vector::Zero(x.size());
    for (Index i = 0; i < v.size(); i += 3) v.segment<3>(i) = velocity;
    add_wind(wind, mesh.triangles, 0, x, v, force);
    return sum_over_vertices(force);
  };
  EXPECT_LE(moving({0, 0, -4}).norm(), 1e-15);
  EXPECT_LE((moving({0, 0, -8}) + moving({0, 0, 0})).norm(), 1e-12);
  EXPECT_LE((moving({1, 1, 0}) - moving({0, 0, 0})).norm(), 1e-12);
}

TEST(ElasticEnergies, OfAStrainedSheetDoNotChangeUnderRigidMotion) {
  RandomValues random(3);
  for (const EnergySpecimen& specimen : energy_specimens()) {
    if (!specimen.name.starts_with("membrane") && !specimen.name.starts_with("bending")) continue;
    const auto energy = specimen.make();
    for (Pose pose : {Pose::stretched, Pose::bent}) {
      const Vector x = posed(pose);
      const double value = Assembly(x.size(), {energy.get()}, {}, 1).value(x);
      const Vector gradient = gradient_of(*energy, x);
      EXPECT_GT(value, 1e-3);
      for (int sample = 0; sample < 20; ++sample) {
        const Matrix3 turn = random.rotation();
        const Vector3 shift(random.value(), random.value(), random.value());
        Vector moved = x, turned_gradient = gradient;
        for (Index v = 0; v < x.size(); v += 3) {
          moved.segment<3>(v) = turn * x.segment<3>(v) + shift;
          turned_gradient.segment<3>(v) = turn * gradient.segment<3>(v);
        }
        EXPECT_NEAR(Assembly(x.size(), {energy.get()}, {}, 1).value(moved), value, 1e-12 * value) << specimen.name;
        EXPECT_LE((gradient_of(*energy, moved) - turned_gradient).norm(), 1e-12 * gradient.norm()) << specimen.name;
        EXPECT_LE(sum_over_vertices(gradient_of(*energy, moved)).norm(), 1e-12 * gradient.norm()) << specimen.name;
      }
    }
  }
}

}  // namespace
}  // namespace taut
