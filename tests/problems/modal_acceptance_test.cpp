// Frequencies against closed forms, truncation, rigid motions, tetrahedra.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "dynamics/modal/modal_basis.h"
#include "dynamics/stepper.h"
#include "energies/linear_tetrahedra.h"
#include "geometry/tetrahedra.h"
#include "problems/build.h"
#include "problems/read_scene.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

constexpr double young = 2e11, density = 7850;

class ModalBody : public FilesTest {
 protected:
  Scene scene(const std::string& size, const std::string& cells, double thickness, double poisson, int modes,
              const std::string& clamp, const std::string& more = "") const {
    std::ofstream(path("scene.json")) << fmt::format(
        R"({{ "format": 1, "time": {{ "integrator": "newmark", "step": 0.001, "steps": 1 }},
          "bodies": {{ "body": {{ "model": "modal", "mesh": {{ "grid": {{ "size": {}, "cells": {}, "diagonals": "alternating" }} }},
            "thickness": {}, "density": {}, "mass": "consistent",
            "material": {{ "law": "stvk", "young_modulus": {}, "poisson_ratio": {} }},
            "modal": {{ "modes": {} {} }} }} }} {} }})",
        size, cells, thickness, density, young, poisson, modes, clamp.empty() ? "" : ", \"clamp\": " + clamp, more);
    return read_scene(path("scene.json"));
  }
};

double rate(double eigenvalue) { return std::sqrt(eigenvalue); }

/// Cantilever of Timoshenko, shear correction 5/6, nu = 0, h/L = 0.01: omega sqrt(rho A L^4/(E I))
/// = 3.515784, 22.024380, 61.629782. Modes that bend in the plane of the strip or twist it are passed over.
TEST_F(ModalBody, CantileverFrequenciesAreWithinAPercentOfTimoshenkos) {
  const ModalBasis basis = build_modal_basis(scene("[1, 0.05]", "[60, 2]", 0.01, 0, 12, "{\"edges\": [\"x0\"]}"));
  const double unit = 0.01 * std::sqrt(young / density / 12);
  const double expected[] = {3.5157838, 22.0243798, 61.6297816};
  for (const double factor : expected) {
    double nearest = 1;
    for (const double value : basis.eigenvalues)
      nearest = std::min(nearest, std::abs(rate(value) / (factor * unit) - 1));
    std::printf("cantilever %.4f: %.3f %% off\n", factor, 100 * nearest);
    EXPECT_LE(nearest, 0.01) << factor;
  }
  EXPECT_LE(basis.residuals.maxCoeff(), 1e-8);
}

/// The error falls with the square of the cell: 1.4 % of the fourth at 40 cells. Clamped square plate: omega a^2
/// sqrt(rho h/D) = 35.98519, 73.39385 (twice), 108.21650.
TEST_F(ModalBody, ClampedPlateFrequenciesAreWithinAPercentOfKirchhoffs) {
  const ModalBasis basis = build_modal_basis(scene("[1, 1]", "[56, 56]", 0.002, 0.3, 4, "{\"boundary\": true}"));
  const double unit = 0.002 * std::sqrt(young / (12 * (1 - 0.09)) / density);
  const double expected[] = {35.985191, 73.393846, 73.393846, 108.216502};
  for (int k = 0; k < 4; ++k) {
    std::printf("plate %.4f: %.3f %% off\n", expected[k],
                100 * (rate(basis.eigenvalues[k]) / (expected[k] * unit) - 1));
    EXPECT_NEAR(rate(basis.eigenvalues[k]) / (expected[k] * unit), 1, 0.01) << k;
  }
}

/// Static tip deflection under a tip force against that of all modes: sum phi^2/lambda. The error of m bending modes is
/// sum_{k > m} 12/(beta_k L)^4.
TEST_F(ModalBody, TruncationErrorFallsWithTheNumberOfModes) {
  const ModalBasis basis = build_modal_basis(scene("[1, 0.05]", "[60, 2]", 0.01, 0, 40, "{\"edges\": [\"x0\"]}"));
  Index tip = 0;
  for (Index node = 0; node < basis.nodes(); ++node)
    if (basis.rest[3 * node] > basis.rest[3 * tip]) tip = node;
  const double length = 1, inertia = 0.05 * 1e-6 / 12, force = 1;
  const double exact = force * length * length * length / (3 * young * inertia);
  double before = 1;
  std::printf("modes  error of the tip's static deflection\n");
  for (const Index modes : {1, 2, 5, 10, 20, 40}) {
    double sum = 0;
    for (Index k = 0; k < modes; ++k) sum += std::pow(basis.shapes(3 * tip + 2, k), 2) / basis.eigenvalues[k];
    const double error = 1 - force * sum / exact;
    std::printf("%5d  %.2e\n", static_cast<int>(modes), error);
    EXPECT_LE(error, before + 1e-9);
    before = error;
    if (modes == 1) {
      EXPECT_NEAR(error, 1 - 12 / std::pow(1.8751041, 4), 0.005);  // 2.9 %
    }
  }
  EXPECT_LE(std::abs(before), 0.005);
}

/// A free plate has six rigid motions, exactly, and turns rigidly through half a turn without a force.
TEST_F(ModalBody, AFreeBodyTurnsRigidlyWithoutStrainOrGhostForce) {
  const ModalBasis basis = build_modal_basis(scene("[0.3, 0.2]", "[6, 4]", 0.002, 0.3, 12, ""));
  EXPECT_EQ(basis.rigid, 6);
  EXPECT_EQ(basis.eigenvalues.head(6), Vector::Zero(6));
  EXPECT_GT(basis.eigenvalues[6], 1e4);
  Vector q = Vector::Zero(12);
  q[5] = 3.0 / basis.rotations(2, 5);  // three radians about z
  const Vector x = basis.positions(q);
  for (Index i = 0; i < x.size(); i += 3) {
    for (Index j = 0; j < i; j += 3) {
      EXPECT_NEAR((x.segment<3>(i) - x.segment<3>(j)).norm(),
                  (basis.rest.segment<3>(i) - basis.rest.segment<3>(j)).norm(), 1e-10);
    }
  }
}

/// A membrane has modes where it is stretched: omega = pi sqrt(2) c/a of the first, c^2 = tension over density, and
/// none where it is slack.
TEST_F(ModalBody, AMembraneHasModesUnderTensionOnly) {
  const auto drum = [&](double scale) {
    std::ofstream(path("drum.json")) << fmt::format(
        R"({{ "format": 1, "time": {{ "integrator": "newmark", "step": 0.001, "steps": 1 }}, "bodies": {{ "drum": {{
          "model": "modal", "mesh": {{ "grid": {{ "size": [1, 1], "cells": [24, 24] }} }}, "rest": {{ "scale": {} }},
          "thickness": 0.001, "density": 1000, "membrane": {{ "law": "stvk", "young_modulus": 1e7, "poisson_ratio": 0.3 }},
          "modal": {{ "modes": 4, "clamp": {{ "boundary": true }} }} }} }} }})",
        scale);
    return build_modal_basis(read_scene(path("drum.json")));
  };
  const double stretch = 1 / 0.99, stress = 1e7 / 0.7 * 0.5 * (stretch * stretch - 1);  // second Piola-Kirchhoff
  // Of the rest density and rest lengths, so that the wave in the stretched sheet has c = stretch sqrt(S/rho).
  const double expected = std::numbers::pi * std::sqrt(2.0) * stretch * std::sqrt(stress / 1000);
  EXPECT_NEAR(rate(drum(0.99).eigenvalues[0]) / expected, 1, 0.01);
  try {
    drum(1);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("a membrane needs bending or tension"), std::string::npos) << error.what();
  }
}

class TetrahedraBody : public ModalBody {
 protected:
  /// The modes of a steel box in cubes of six tetrahedra, nu = 0.
  ModalBasis box_modes(const TetrahedronMesh& box, int modes, const std::string& clamp) const {
    std::ofstream file(path("box.msh"));
    file << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << box.vertices.size() << "\n";
    for (std::size_t v = 0; v < box.vertices.size(); ++v) file << v + 1 << " " << box.vertices[v].transpose() << "\n";
    file << "$EndNodes\n$Elements\n" << box.cells.size() << "\n";
    for (std::size_t c = 0; c < box.cells.size(); ++c) {
      file << c + 1 << " 4 2 0 1";
      for (const int corner : box.cells[c]) file << " " << corner + 1;
      file << "\n";
    }
    file << "$EndElements\n";
    file.close();
    std::ofstream(path("solid.json")) << fmt::format(
        R"({{ "format": 1, "time": {{ "integrator": "newmark", "step": 0.001, "steps": 1 }},
          "bodies": {{ "rod": {{ "model": "modal", "mesh": {{ "file": "box.msh" }}, "density": {}, "mass": "consistent",
            "material": {{ "law": "stvk", "young_modulus": {}, "poisson_ratio": 0 }},
            "modal": {{ "modes": {} {} }} }} }} }})",
        density, young, modes, clamp);
    return build_modal_basis(read_scene(path("solid.json")));
  }
};

/// A free rod: bending and torsion lock, but stretching along the rod does not.
TEST_F(TetrahedraBody, FromAFileHaveSixRigidMotionsAndLongitudinalFrequencies) {
  const ModalBasis basis = box_modes(make_box({1, 0.05, 0.05}, 40, 2, 2), 40, "");
  EXPECT_EQ(basis.rigid, 6);
  const double expected = std::numbers::pi * std::sqrt(young / density);  // free ends, nu = 0
  double nearest = 1;
  for (const double value : basis.eigenvalues) nearest = std::min(nearest, std::abs(rate(value) / expected - 1));
  std::printf("rod of tetrahedra, first longitudinal frequency: %.3f %% off\n", 100 * nearest);
  EXPECT_LE(nearest, 0.01);
}

/// How much too stiff: a square cantilever, thickness over length 0.1, in n cells through the thickness. Bending of
/// Timoshenko; torsion omega = pi/(2 L) sqrt(G J/(rho I)), J = 0.140577 a^4, I = a^4/6. The errors fall with the square
/// of the cell.
TEST_F(TetrahedraBody, LockInBendingAndTorsionByAnErrorThatFallsWithTheSquareOfTheCell) {
  constexpr double a = 0.1;
  const double bending = 3.4931411 * a * std::sqrt(young / density / 12);
  const double torsion = std::numbers::pi / 2 * std::sqrt(0.5 * young * 0.140577 * 6 / density);
  std::printf("cells through  tetrahedra  bending too high by, %%  torsion too high by, %%\n");
  double before[2] = {0, 0};
  for (const int n : {1, 2, 4, 8}) {
    const TetrahedronMesh box = make_box({1, a, a}, 10 * n, n, n);
    const ModalBasis basis =
        box_modes(box, 12, R"(, "clamp": { "box": { "min": [-1, -1, -1], "max": [1e-6, 1, 1] } })");
    // The lowest is in bending; the lowest that turns the tip about x above all is in torsion.
    Index tip = 0;
    for (Index node = 0; node < basis.nodes(); ++node)
      if (basis.rest.segment<3>(3 * node).sum() > basis.rest.segment<3>(3 * tip).sum()) tip = node;
    Index twist = 0;
    const auto turn = [&](Index mode) -> Vector3 { return basis.rotations.block<3, 1>(3 * tip, mode); };
    while (twist < basis.modes() && std::abs(turn(twist)[0]) < 0.9 * turn(twist).norm()) ++twist;
    ASSERT_LT(twist, basis.modes());
    const double errors[2] = {rate(basis.eigenvalues[0]) / bending - 1, rate(basis.eigenvalues[twist]) / torsion - 1};
    std::printf("%13d  %10zu  %22.2f  %22.2f\n", n, box.cells.size(), 100 * errors[0], 100 * errors[1]);
    for (int k = 0; k < 2; ++k) {
      EXPECT_GT(errors[k], 0) << n;
      if (n == 8) {
        EXPECT_NEAR(std::log2(before[k] / errors[k]), 2, 0.3) << n;
      }
      before[k] = errors[k];
    }
  }
}

}  // namespace
}  // namespace taut
