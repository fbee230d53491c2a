// Warped modes on meshes against linear modes and against the full nonlinear thick shell: the same mesh, the same dead
// forces, three models. And the ghost forces of a free body.
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

/// A strip along x of length 1 m in one layer of prisms, clamped at x = 0 or free.
struct Strip {
  double width, thickness;  // m
  int cells, cells_across;
  bool clamped = true;
};

class WarpingOnMeshes : public FilesTest {
 protected:
  /// `moment`: at the end of the full body, bending it up, N per m of width.
  Scene scene(const Strip& strip, bool modal, int modes, int steps, double moment = 0) const {
    const std::string clamp = R"("clamp": { "edges": ["x0"] })";
    const std::string model =
        modal ? fmt::format(R"("modal", "modal": {{ "modes": {} {} }})", modes, strip.clamped ? ", " + clamp : "")
              : "\"thick_shell\"";
    std::ofstream(path("scene.json")) << fmt::format(
        R"({{ "format": 1, "time": {{ "integrator": "static", "steps": {} }},
          "bodies": {{ "strip": {{ "model": {}, "mesh": {{ "grid": {{ "size": [1, {}], "cells": [{}, {}],
            "diagonals": "alternating" }} }}, "transform": {{ "translate": [0, {}, 0] }},
            "thickness": {}, "density": {}, "mass": "consistent",
            "material": {{ "law": "stvk", "young_modulus": {}, "poisson_ratio": 0 }} }} }} {} {} }})",
        steps, model, strip.width, strip.cells, strip.cells_across, -strip.width / 2, strip.thickness, density, young,
        modal || !strip.clamped
            ? ""
            : R"(, "constraints": { "clamp": { "type": "pin", "body": "strip", "select": { "edges": ["x0"] } } })",
        moment == 0 ? ""
                    : fmt::format(R"(, "loads": {{ "moment": {{ "type": "end_moment", "body": "strip",
            "select": {{ "edges": ["x1"] }}, "moment_per_length": [0, {}, 0] }} }})",
                                  -moment));
    return read_scene(path("scene.json"));
  }

  /// Positions of the nodes at rest under dead forces, which grow in `steps` steps.
  Vector equilibrium(const Scene& scene, const Vector& forces, bool warped = true) const {
    const auto model = build_model(scene);
    if (model->modal) {
      auto basis = std::make_shared<ModalBasis>(*model->modal);
      basis->warped = warped;
      model->modal = basis;
      model->warped_loads.push_back(std::make_unique<WarpedLoad>("forces", *basis, forces));
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
    const auto body = build_model(full);
    for (const auto& inertia : body->inertia)
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
  /// Mean position of the nodes at the tip.
  static Vector3 tip(const ModalBasis& basis, const Vector& x) {
    Vector3 sum = Vector3::Zero();
    int count = 0;
    for (Index node = 0; node < basis.nodes(); ++node) {
      if (basis.rest[3 * node] < 1 - 1e-9) continue;
      sum += x.segment<3>(3 * node);
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
    EXPECT_NEAR(e.warped / slenderness, 0.13, 0.01);  // 0.6 % at 0.05, as the closed form of a round bar
    EXPECT_GT(e.linear, 0.25);
    if (before > 0) {
      EXPECT_NEAR(before / e.warped, 2, 0.1);
    }
    before = e.warped;
  }
}

TEST_F(WarpingOnMeshes, BendingIsCloserToTheNonlinearBodyThanLinearModes) {
  const Strip strip{0.05, 0.01, 40, 1};
  const ModalBasis basis = build_modal_basis(scene(strip, true, 20, 1));
  std::printf("bending, degrees at the tip   linear modes   warped modes\n");
  for (const double degrees : {5.0, 10.0, 20.0, 30.0, 60.0, 90.0}) {
    const Errors e = errors(strip, basis, mode_about(basis, 1), degrees * std::numbers::pi / 180, 4);
    std::printf("%26.0f %14.2e %14.2e\n", degrees, e.linear, e.warped);
    EXPECT_LT(e.warped, 0.2 * e.linear) << degrees;
    EXPECT_LT(e.warped, 0.1) << degrees;
  }
}

/// A couple at the tip: the modes' static response, warped, against the arc of a circle has the error of the closed
/// form (sin t/t - 1, (1 - cos t)/t) against (-(1 - cos t)/2, (sin t)/2), but for what 40 modes leave out; the full
/// shell has none to speak of.
TEST_F(WarpingOnMeshes, PureBendingHasTheErrorOfItsClosedForm) {
  const Strip strip{0.05, 0.01, 40, 1};
  const ModalBasis basis = build_modal_basis(scene(strip, true, 40, 1));
  const double stiffness = young * std::pow(strip.thickness, 3) / 12;  // per width
  std::printf(
      "pure bending, degrees   closed form   warped (20, 40 modes)   linear   full shell (tip's error, of the "
      "length)\n");
  for (const double degrees : {10.0, 30.0, 60.0, 90.0}) {
    const double t = degrees * std::numbers::pi / 180;
    Vector couple = Vector::Zero(basis.rest.size());
    for (Index node = 0; node < basis.nodes(); ++node) {
      if (basis.rest[3 * node] < 1 - 1e-9) continue;
      const double up = basis.rest[3 * node + 2] > 0 ? 1 : -1;  // two nodes below, two above
      couple[3 * node] = -up * stiffness * t * strip.width / (2 * strip.thickness);
    }
    const Vector3 exact(std::sin(t) / t, 0, (1 - std::cos(t)) / t);
    const Vector3 closed(1 - (1 - std::cos(t)) / 2, 0, std::sin(t) / 2);
    const auto error_of = [&](Index modes, bool warped) {
      ModalBasis fewer = basis.truncated(modes);
      fewer.warped = warped;
      const Vector q = (fewer.shapes.transpose() * couple).cwiseQuotient(fewer.eigenvalues);
      return (tip(basis, fewer.positions(q)) - exact).norm();
    };
    const Vector full = equilibrium(scene(strip, false, 0, 6, stiffness * t), Vector::Zero(basis.rest.size()));
    const double expected = (closed - exact).norm(), few = error_of(20, true), many = error_of(40, true),
                 linear = error_of(40, false), shell = (tip(basis, full) - exact).norm();
    std::printf("%21.0f %13.2e %13.2e %9.2e %8.2e %12.2e\n", degrees, expected, few, many, linear, shell);
    EXPECT_LT(std::abs(many - expected), 0.6 * std::abs(few - expected)) << degrees;
    EXPECT_NEAR(many / expected, 1, 0.07) << degrees;
    EXPECT_NEAR(linear / many, 2, 0.25) << degrees;
    EXPECT_LT(shell, 0.01 * expected) << degrees;
  }
}

/// A free plate that turns about x and vibrates in one of its first six modes. Nothing pushes it: its centre should
/// stay. What it moves by, over time, is what ghost forces do. All relative: to the vibration's amplitude a, and to m a
/// omega^2.
TEST_F(WarpingOnMeshes, GhostForcesOfAFreeSpinningBodyAreMeasuredOverTime) {
  const Strip plate{2.0 / 3, 1.0 / 150, 12, 8, false};
  const ModalBasis basis = build_modal_basis(scene(plate, true, 12, 1));
  const auto full = build_model(scene(plate, false, 0, 1));
  Vector weights = Vector::Zero(basis.rest.size());  // mass of each coordinate, over the whole mass
  full->inertia[0]->add_product(Vector::Ones(weights.size()), weights);
  weights *= 3 / weights.sum();
  const auto centre_of = [&](double turn, Index mode, double deflection) -> Vector3 {
    Vector q = Vector::Zero(12);
    q[3] = turn / basis.rotations.block(0, 3, 3, 1).norm();
    q[mode] = deflection / basis.shapes.col(mode).lpNorm<Eigen::Infinity>();
    return basis.positions(q).cwiseProduct(weights).reshaped(3, basis.nodes()).rowwise().sum();
  };
  constexpr double amplitude = 1e-3;
  const Vector3 start = centre_of(0, 6, 0);
  Index mode = 6;  // the one whose ghost forces are largest
  for (Index k = 7; k < 12; ++k) {
    if ((centre_of(1, k, amplitude) - start).norm() > (centre_of(1, mode, amplitude) - start).norm()) mode = k;
  }
  const double omega = std::sqrt(basis.eigenvalues[mode]), spin = 0.01 * omega;  // rad/s
  const auto centre = [&](double time, double a) { return centre_of(spin * time, mode, a * std::cos(omega * time)); };
  std::printf("vibrations  turn, rad  centre off by, of the amplitude  its mean  ghost force, of m a omega^2\n");
  const double period = 2 * std::numbers::pi / omega, h = period / 200;
  std::vector<double> off;
  for (const int vibrations : {0, 4, 8, 16, 32, 64}) {
    double farthest = 0, force = 0;  // the largest within one vibration
    Vector3 mean = Vector3::Zero();
    for (int k = 0; k < 200; ++k) {
      const double t = vibrations * period + k * h;
      const Vector3 here = (centre(t, amplitude) - start) / amplitude;
      const Vector3 push = (centre(t + h, amplitude) - 2 * centre(t, amplitude) + centre(t - h, amplitude)) / (h * h);
      farthest = std::max(farthest, here.norm());
      force = std::max(force, push.norm() / (amplitude * omega * omega));
      mean += here / 200;
    }
    std::printf("%10d  %9.2f  %31.3f  %8.3f  %28.3f\n", vibrations, spin * vibrations * period, farthest, mean.norm(),
                force);
    EXPECT_LT(mean.norm(), 0.05);  // it swings with the vibration and does not drift
    off.push_back(farthest);
  }
  EXPECT_NEAR(off[2] / off[1], 2, 0.25);  // in proportion to the turn at first
  EXPECT_LT(off[5], 2);
  const auto shift = [&](double a) { return (centre(20 * period, a) - start).norm(); };
  EXPECT_NEAR(shift(2 * amplitude) / shift(amplitude), 2, 0.05);
}

}  // namespace
}  // namespace taut
