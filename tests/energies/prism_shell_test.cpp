#include "energies/prism_shell.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/assembly.h"
#include "support/meshes.h"
#include "support/random_values.h"
#include "support/shells.h"

namespace taut {
namespace {

SolidMaterial stvk(double young, double ratio) { return SolidMaterial::isotropic(SolidLaw::stvk, young, ratio); }
SolidMaterial neo_hookean(double young, double ratio) {
  return SolidMaterial::isotropic(SolidLaw::neo_hookean, young, ratio);
}

PrismShellOptions plain() {
  PrismShellOptions options;
  options.element = PrismElement::plain;
  return options;
}

/// A patch of 2 m x 1 m with inner vertices off the grid, thickness 0.1.
TriangleMesh patch_mesh() {
  TriangleMesh mesh = make_grid(2, 1, 4, 3, Diagonals::alternating);
  RandomValues random(9);
  for (Vector3& v : mesh.vertices) {
    const bool inside = v.x() > 0 && v.x() < 2 && v.y() > 0 && v.y() < 1;
    if (inside) v += 0.08 * Vector3(random.value(), random.value(), 0);
  }
  return mesh;
}

bool on_boundary(const Vector3& v) { return v.x() == 0 || v.x() == 2 || v.y() == 0 || v.y() == 1; }

Matrix rest_stiffness(const Energy& energy, const std::vector<Vector3>& nodes) {
  const Vector x = flatten(nodes);
  Assembly assembly(x.size(), {&energy}, {}, 1);
  assembly.hessian(x, Curvature::exact);
  return Matrix(assembly.matrix()).selfadjointView<Eigen::Lower>();
}

int zero_modes(const Energy& energy, const std::vector<Vector3>& nodes) {
  const Vector values =
      Eigen::SelfAdjointEigenSolver<Matrix>(rest_stiffness(energy, nodes), Eigen::EigenvaluesOnly).eigenvalues();
  return static_cast<int>((values.array().abs() < 1e-10 * values.maxCoeff()).count());
}

struct Variant {
  std::string name;
  SolidMaterial material;
  PrismShellOptions options;
};

std::vector<Variant> variants() {
  PrismShellOptions uncured, fine;
  uncured.enhanced_thickness = false;
  fine.points_in_plane = 6;
  fine.points_in_thickness = 3;
  return {{"plain", stvk(3, 0.3), plain()},
          {"plain_neo_hookean", neo_hookean(3, 0.3), plain()},
          {"assumed", stvk(3, 0.3), {}},
          {"assumed_neo_hookean", neo_hookean(3, 0.45), {}},
          {"uncured", stvk(3, 0.3), uncured},
          {"fine_quadrature", neo_hookean(3, 0.3), fine},
          {"ply", SolidMaterial::ply({25, 1, 0.5, 0.2, 0.25, 0.25}), {}}};
}

TEST(PrismShell, OfOneElementHasExactlySixZeroModes) {
  for (const Variant& v : variants()) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const auto points = random_prism(seed, seed % 2 == 0 ? 0.3 : 0.0);
      const std::vector<Vector3> nodes(points.begin(), points.end());
      const PrismShell shell("one", rest_prisms({{0, 1, 2, 3, 4, 5}}, nodes), v.material, v.options);
      EXPECT_EQ(zero_modes(shell, nodes), 6) << v.name << ", seed " << seed;
    }
  }
}

TEST(PrismShell, WithOnePointInThePlaneHasASeventhZeroMode) {
  PrismShellOptions options;
  options.points_in_plane = 1;
  const auto points = random_prism(1, 0);
  const std::vector<Vector3> nodes(points.begin(), points.end());
  const PrismShell shell("one", rest_prisms({{0, 1, 2, 3, 4, 5}}, nodes), stvk(3, 0.3), options);
  EXPECT_GT(zero_modes(shell, nodes), 6);
}

TEST(PrismShell, OfAPatchInOneOrTwoLayersHasExactlySixZeroModes) {
  for (const Variant& v : variants()) {
    for (const std::vector<double>& fractions : {std::vector{1.0}, std::vector{0.4, 0.6}}) {
      const LayeredMesh layered = make_layered(patch_mesh(), std::vector{0.1}, fractions, "patch");
      const PrismShell shell("patch", rest_prisms(layered.prisms, layered.nodes), v.material, v.options);
      EXPECT_EQ(zero_modes(shell, layered.nodes), 6) << v.name << ", layers " << fractions.size();
    }
  }
}

TEST(PrismShell, IsAtRestWhereverItIsMoved) {
  RandomValues random(2);
  const auto points = random_prism(4, 0.3);
  const std::vector<Vector3> nodes(points.begin(), points.end());
  const Matrix3 turn = random.rotation();
  const Vector3 shift = random.vector(3);
  const Vector x = flatten(mapped(nodes, [&](const Vector3& p) { return Vector3(turn * p + shift); }));
  for (const Variant& v : variants()) {
    const PrismShell shell("one", rest_prisms({{0, 1, 2, 3, 4, 5}}, nodes), v.material, v.options);
    Vector gradient(18);
    EXPECT_NEAR(shell.evaluate(0, x.data(), gradient.data(), nullptr, Curvature::exact), 0, 1e-15) << v.name;
    EXPECT_LE(gradient.cwiseAbs().maxCoeff(), 1e-14) << v.name;
  }
}

TEST(PrismShell, HasAnEnergyThatRigidMotionsDoNotChange) {
  RandomValues random(2);
  const auto points = random_prism(4, 0.3);
  const std::vector<Vector3> nodes(points.begin(), points.end());
  const std::vector<Vector3> bent =
      mapped(nodes, [&](const Vector3& p) { return Vector3(p + 0.05 * random.vector(3)); });
  const Matrix3 turn = random.rotation();
  const Vector x = flatten(bent);
  const Vector y = flatten(mapped(bent, [&](const Vector3& p) { return Vector3(turn * p + Vector3(1, 2, 3)); }));
  for (const Variant& v : variants()) {
    const PrismShell shell("one", rest_prisms({{0, 1, 2, 3, 4, 5}}, nodes), v.material, v.options);
    const double value = shell.evaluate(0, x.data(), nullptr, nullptr, Curvature::exact);
    EXPECT_GT(value, 1e-6);
    EXPECT_NEAR(shell.evaluate(0, y.data(), nullptr, nullptr, Curvature::exact), value, 1e-12 * value) << v.name;
  }
}

/// Prescribes `field` on the boundary of the flat patch, loads top and bottom with `traction` (Pa) and its opposite,
/// solves for the inside, and returns the largest deviation from `field` there relative to the largest value.
double patch_error(const Variant& variant, const std::function<Vector3(const Vector3&)>& field,
                   const Vector3& traction) {
  const TriangleMesh mesh = patch_mesh();
  const LayeredMesh layered = make_layered(mesh, std::vector{0.1}, {1.0}, "patch");
  const PrismShell shell("patch", rest_prisms(layered.prisms, layered.nodes), variant.material, variant.options);
  const Matrix k = rest_stiffness(shell, layered.nodes);
  const Vector exact = flatten(mapped(layered.nodes, field));
  Vector load = Vector::Zero(exact.size());
  for (const Triangle& t : mesh.triangles) {
    const Vector3 a = mesh.vertices[t[1]] - mesh.vertices[t[0]], b = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    for (int vertex : t) {
      load.segment<3>(3 * layered.node(vertex, 1)) += traction * (a.cross(b).norm() / 6);
      load.segment<3>(3 * layered.node(vertex, 0)) -= traction * (a.cross(b).norm() / 6);
    }
  }
  std::vector<int> inner;
  for (std::size_t node = 0; node < layered.nodes.size(); ++node) {
    if (on_boundary(mesh.vertices[node / 2])) continue;
    for (int axis = 0; axis < 3; ++axis) inner.push_back(static_cast<int>(3 * node) + axis);
  }
  Vector boundary = exact;
  for (const int i : inner) boundary[i] = 0;
  const Vector solution = Matrix(k(inner, inner)).ldlt().solve((load - k * boundary)(inner));
  return (solution - exact(inner)).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
}

/// The patch test for a uniform displacement gradient, with the tractions that keep it in balance.
double uniform_patch_error(const Variant& variant, const Matrix3& gradient) {
  Voigt strain;
  strain << gradient(0, 0), gradient(1, 1), gradient(2, 2), gradient(0, 1) + gradient(1, 0),
      gradient(0, 2) + gradient(2, 0), gradient(1, 2) + gradient(2, 1);
  const Voigt stress = variant.material.elasticity * strain;
  return patch_error(variant, [&](const Vector3& p) -> Vector3 { return gradient * p; },
                     {stress[4], stress[5], stress[2]});
}

TEST(PrismShell, PassesTheMembranePatchTestInPlaneStress) {
  for (const Variant& v : variants()) {
    Matrix3 gradient = Matrix3::Zero();
    gradient.topLeftCorner<2, 2>() << 0.5, 0.2, -0.3, -0.4;
    const Elasticity& d = v.material.elasticity;
    gradient(2, 2) = -(d(2, 0) * gradient(0, 0) + d(2, 1) * gradient(1, 1)) / d(2, 2);
    EXPECT_LE(uniform_patch_error(v, gradient), 1e-10) << v.name;
  }
}

TEST(PrismShell, PassesTheShearPatchTest) {
  for (const Variant& v : variants()) {
    Matrix3 gradient = Matrix3::Zero();
    gradient.col(2) << 0.7, -0.4, 0;
    EXPECT_LE(uniform_patch_error(v, gradient), 1e-10) << v.name;
    gradient = gradient.transpose().eval();
    EXPECT_LE(uniform_patch_error(v, gradient), 1e-10) << v.name;
  }
}

TEST(PrismShell, PassesThePatchTestForAnyUniformStrain) {
  RandomValues random(3);
  for (const Variant& v : variants()) EXPECT_LE(uniform_patch_error(v, random.matrix(3, 3)), 1e-10) << v.name;
}

/// Pure bending, w = (a x^2 + 2 c x y + b y^2)/2 and u = -z grad w. The plain element fails this.
TEST(PrismShell, WithAssumedStrainsPassesTheBendingPatchTestWherePlainLocks) {
  const auto bending = [](const Vector3& p) {
    const double a = 0.5, b = -0.3, c = 0.4;
    return Vector3(-p.z() * (a * p.x() + c * p.y()), -p.z() * (c * p.x() + b * p.y()),
                   0.5 * (a * p.x() * p.x() + b * p.y() * p.y()) + c * p.x() * p.y());
  };
  for (const Variant& v : variants()) {
    const double error = patch_error(v, bending, Vector3::Zero());
    if (v.options.element == PrismElement::plain) {
      EXPECT_GT(error, 1e-3) << v.name;
    } else {
      EXPECT_LE(error, 1e-10) << v.name;
    }
  }
}

TEST(PrismShell, InUniaxialTensionHasTheExactStress) {
  // One element freely contracting: E11 given, S22 = S33 = 0 by minimisation over the other strains.
  for (const SolidMaterial& material : {stvk(3, 0.3), stvk(3, 0.49)}) {
    ShellCase patch(patch_mesh(), 0.1);
    patch.set_material(-1, material, {});
    for (int v = 0; v < patch.vertices(); ++v) {
      const Vector3& p = patch.mesh.vertices[v];
      if (p.x() == 0) patch.fix(v, 0);
      if (p.x() == 0 && p.y() == 0) patch.fix(v, 1);
      if (p.x() == 0 && p.y() == 0) patch.fixed[3 * patch.layered.node(v, 0) + 2] = true;
      if (p.x() == 0 && p.y() == 1) patch.fixed[3 * patch.layered.node(v, 0) + 2] = true;
      if (p.x() == 2 && p.y() == 0) patch.fixed[3 * patch.layered.node(v, 0) + 2] = true;
      // A traction on the end x = 2 of 1 Pa: three cells along it, area 0.1.
      if (p.x() == 2) patch.add_force(v, {0.1 / 3 * (p.y() == 0 || p.y() == 1 ? 0.5 : 1.0), 0, 0});
    }
    const Vector u = patch.linear_displacement();
    const double ratio = -material.elasticity.inverse()(0, 1) * 3;
    for (int v = 0; v < patch.vertices(); ++v) {
      const Vector3& p = patch.mesh.vertices[v];
      EXPECT_NEAR(patch.mean(v, u).x(), p.x() / 3, 1e-12);
      EXPECT_NEAR(patch.mean(v, u).y(), -ratio * p.y() / 3, 1e-12);
      const double thinning = u[3 * patch.layered.node(v, 1) + 2] - u[3 * patch.layered.node(v, 0) + 2];
      EXPECT_NEAR(thinning, -ratio * 0.1 / 3, 1e-12);
    }
  }
}

TEST(PrismShell, TurnsTheFibresOfAPlyWithItsDirection) {
  const auto points = random_prism(1, 0);
  const std::vector<Vector3> nodes(points.begin(), points.end());
  const PrismShape shape(points);
  const Vector3 a = shape.mid.col(1) - shape.mid.col(0);
  const Vector3 n = a.cross(shape.mid.col(2) - shape.mid.col(0)).normalized(), b = n.cross(a).normalized();
  const SolidMaterial ply = SolidMaterial::ply({25, 1, 0.5, 0.2, 0.25, 0.25});
  const auto stretched = [&](const Vector3& axis) {
    return flatten(mapped(nodes, [&](const Vector3& p) { return Vector3(p + 1e-4 * axis.dot(p) * axis); }));
  };
  const double volume = PrismJacobian(shape).volume();
  const Vector3 along = a.normalized();
  const PrismShell fibres_a("a", rest_prisms({{0, 1, 2, 3, 4, 5}}, nodes, along), ply, {});
  const PrismShell fibres_b("b", rest_prisms({{0, 1, 2, 3, 4, 5}}, nodes, b), ply, {});
  const double e = 1e-4 + 0.5e-8;
  const auto energy = [&](const PrismShell& shell, const Vector3& axis) {
    return shell.evaluate(0, stretched(axis).data(), nullptr, nullptr, Curvature::exact);
  };
  const double stiff = 0.5 * volume * e * e * ply.elasticity(0, 0), soft = 0.5 * volume * e * e * ply.elasticity(1, 1);
  EXPECT_NEAR(energy(fibres_a, along), stiff, 1e-6 * stiff);
  EXPECT_NEAR(energy(fibres_b, along), soft, 1e-6 * stiff);
  EXPECT_NEAR(energy(fibres_b, b), stiff, 1e-6 * stiff);
}

TEST(PrismShell, ReportsTheStateOfBendingInPlaneStress) {
  const double curvature = 1e-7, young = 3, ratio = 0.3;  // terms of second order are below 1e-6 of the first
  const TriangleMesh mesh = make_grid(1, 1, 1, 1, Diagonals::right);
  const LayeredMesh layered = make_layered(mesh, std::vector{0.1}, {1.0}, "plate");
  const Vector x = flatten(mapped(layered.nodes, [&](const Vector3& p) {
    return Vector3(p.x() - curvature * p.z() * p.x(), p.y(), p.z() + 0.5 * curvature * p.x() * p.x());
  }));
  for (const SolidMaterial& material : {stvk(young, ratio), neo_hookean(young, ratio)}) {
    const PrismShell shell("plate", rest_prisms(layered.prisms, layered.nodes), material, {});
    Vector local(18);
    shell.stencils().gather(0, x, local.data());
    const PrismState top = shell.state(0, local.data(), Vector3::Constant(1.0 / 3), 1);
    const double stretch = -0.05 * curvature;
    EXPECT_LE((top.frame - Matrix3::Identity()).norm(), 1e-15);
    EXPECT_NEAR(top.strain[0], stretch, 1e-4 * std::abs(stretch));
    EXPECT_NEAR(top.strain[2], -ratio / (1 - ratio) * stretch, 1e-4 * std::abs(stretch));
    EXPECT_NEAR(top.stress[0], young / (1 - ratio * ratio) * stretch, 1e-4 * std::abs(young * stretch));
    EXPECT_NEAR(top.stress[1], ratio * top.stress[0], 1e-4 * std::abs(young * stretch));
    EXPECT_LE(top.stress.tail<4>().norm(), 1e-4 * std::abs(young * stretch));
    EXPECT_NEAR(shell.state(0, local.data(), Vector3::Constant(1.0 / 3), -1).stress[0], -top.stress[0],
                1e-4 * std::abs(young * stretch));
  }
}

TEST(PrismShell, ReportsStressesThatDoTheWorkOfTheShearCorrection) {
  const LayeredMesh layered = make_layered(make_grid(1, 1, 1, 1, Diagonals::right), std::vector{0.1}, {1.0}, "plate");
  PrismShellOptions options;
  options.shear_correction = 0.5;
  const PrismShell shell("plate", rest_prisms(layered.prisms, layered.nodes), stvk(2, 0), options);
  const Vector x =
      flatten(mapped(layered.nodes, [](const Vector3& p) { return Vector3(p.x() + 1e-6 * p.z(), p.y(), p.z()); }));
  Vector local(18);
  shell.stencils().gather(0, x, local.data());
  const PrismState state = shell.state(0, local.data(), Vector3::Constant(1.0 / 3), 0);
  EXPECT_NEAR(state.stress[4], 0.5 * 1e-6, 1e-11);  // G = 1
}

TEST(PrismShell, OfBothLawsAgreesAtSmallStrains) {
  RandomValues random(6);
  const auto points = random_prism(2, 0.2);
  const std::vector<Vector3> nodes(points.begin(), points.end());
  for (const PrismShellOptions& options : {plain(), PrismShellOptions{}}) {
    const Prism prism{0, 1, 2, 3, 4, 5};
    const Matrix a = rest_stiffness(PrismShell("a", rest_prisms({prism}, nodes), stvk(3, 0.4), options), nodes);
    const Matrix b = rest_stiffness(PrismShell("b", rest_prisms({prism}, nodes), neo_hookean(3, 0.4), options), nodes);
    EXPECT_LE((a - b).cwiseAbs().maxCoeff(), 1e-13 * a.cwiseAbs().maxCoeff());
  }
}

TEST(PrismShell, OfNeoHookeanMaterialStopsStepsBeforeItInverts) {
  const auto points = random_prism(3, 0.2);
  const std::vector<Vector3> nodes(points.begin(), points.end());
  const PrismShell shell("one", rest_prisms({{0, 1, 2, 3, 4, 5}}, nodes), neo_hookean(3, 0.3), {});
  const Vector x = flatten(nodes);
  // Turns the prism inside out at half of the step: every director to its opposite.
  Vector dx(18);
  for (int j = 0; j < 3; ++j) {
    const Vector3 n = 0.5 * (points[2 * j + 1] - points[2 * j]);
    dx.segment<3>(6 * j) = 2 * n;
    dx.segment<3>(6 * j + 3) = -2 * n;
  }
  EXPECT_TRUE(shell.guards_steps());
  EXPECT_NEAR(shell.largest_step(0, x.data(), dx.data()), 0.5, 1e-6);
  EXPECT_EQ(shell.largest_step(0, x.data(), Vector(0.1 * dx).data()), std::numeric_limits<double>::infinity());
  const Vector collapsed = x + 0.5 * dx;
  EXPECT_EQ(shell.evaluate(0, collapsed.data(), nullptr, nullptr, Curvature::exact),
            std::numeric_limits<double>::infinity());
}

TEST(PrismShell, RefusesInvertedPrismsAndOptionsOutOfRange) {
  auto points = random_prism(3, 0.2);
  const std::vector<Vector3> nodes(points.begin(), points.end());
  const Prism upright{0, 1, 2, 3, 4, 5}, inverted{1, 0, 3, 2, 5, 4};
  EXPECT_THROW(PrismShell("one", rest_prisms({inverted}, nodes), stvk(3, 0.3), {}), std::invalid_argument);
  PrismShellOptions options;
  options.points_in_plane = 2;
  EXPECT_THROW(PrismShell("one", rest_prisms({upright}, nodes), stvk(3, 0.3), options), std::invalid_argument);
  options = {};
  options.points_in_thickness = 1;
  EXPECT_THROW(PrismShell("one", rest_prisms({upright}, nodes), stvk(3, 0.3), options), std::invalid_argument);
  EXPECT_THROW(stvk(3, 0.5), std::invalid_argument);
  EXPECT_THROW(SolidMaterial::ply({1, 1, 1, 1, 1.2, 0.3}), std::invalid_argument);
}

}  // namespace
}  // namespace taut
