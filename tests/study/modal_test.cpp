#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "dynamics/modal/modal_basis.h"
#include "dynamics/stepper.h"
#include "files/atomic_file.h"
#include "problems/build.h"
#include "problems/modal_file.h"
#include "study/acceleration_stream.h"
#include "study/check.h"
#include "study/run.h"
#include "study/step_trial.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/modal_scene.h"

namespace taut {
namespace {

using testing::HasSubstr;

class Modal : public FilesTest {
 protected:
  Scene scene(const Overrides& overrides = {}, int modes = 12) const {
    return modal_scene(path("."), overrides, modes);
  }
  static std::string text_of(const std::function<void()>& action) {
    try {
      action();
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(Modal, ARunIsSolvedAndItsCheckFindsNothing) {
  RunOptions options;
  options.folder = path("out");
  options.threads = 1;
  const RunSummary summary = run(scene(), options);
  EXPECT_EQ(summary.status, Status::solved) << summary.message;
  EXPECT_EQ(summary.steps_done, 6);
  const CheckReport report = check_run(path("out"), {});
  EXPECT_EQ(report.verdict(), CheckVerdict::within)
      << testing::PrintToString(report.findings) << testing::PrintToString(report.unusable);
  EXPECT_EQ(report.frames.size(), 4);
}

/// At rest the hand carries 3 E I d/L^3, and of the weight 3/8 (a beam propped at its end).
TEST_F(Modal, TheForceOfTheHandIsThatOfABeamAtRest) {
  RunOptions options;
  options.threads = 1;
  const Scene still =
      scene({{"time.integrator", "static"},
             {"time.steps", "1"},
             {"bodies.ruler.material.poisson_ratio", "0"},
             {"constraints.hand.motion", R"({"keyframes": [{"time": 1, "translation": [0, 0, 0.005]}]})"}});
  const RunSummary summary = run(still, options);
  EXPECT_EQ(summary.status, Status::solved) << summary.message;
  const double bending = 3 * 2e11 * (0.03 * 1e-9 / 12) * 0.005 / (0.3 * 0.3 * 0.3);
  const double weight = 7850 * 0.3 * 0.03 * 0.001 * 9.81;
  EXPECT_NEAR(summary.probes[0].value, bending + 3.0 / 8 * weight, 0.01 * (bending + weight));
}

/// The same step solved by four methods that share nothing but the Problem.
TEST_F(Modal, SolversAgreeOnEveryStep) {
  const Scene reference = scene();
  const std::vector<State> states = states_of(reference, 6);
  ASSERT_EQ(states.size(), 6);
  const double size = 0.3;
  std::vector<std::vector<StepTrial>> all;
  for (const char* method : {"augmented_lagrangian", "null_space", "ipopt", "nlopt"}) {
    const Scene other = scene({{"solver.method", method}});
    const auto solver = build_solver(other, 1);
    all.push_back(compare_steps(other, states, *solver));
    for (const StepTrial& trial : all.back()) EXPECT_EQ(trial.judged, Status::solved) << method << " " << trial.step;
  }
  const auto basis = build_modal_basis(reference);
  for (std::size_t k = 0; k < 6; ++k) {
    const Vector x = basis.positions(all[0][k].result.x);
    for (std::size_t s = 1; s < all.size(); ++s)
      EXPECT_LE((basis.positions(all[s][k].result.x) - x).lpNorm<Eigen::Infinity>(), 1e-6 * size) << s << " " << k;
  }
}

/// A mode of eigenvalue lambda under Rayleigh and modal damping, c = alpha + beta lambda + 2 zeta sqrt(lambda), and let
/// go with velocity 1 at rest: q = exp(-c t/2) sin(w t)/w, w^2 = lambda - c^2/4. Returns |error| of q after two periods
/// and the rate at which the amplitude sqrt(w^2 q^2 + (v + c q/2)^2) has decayed.
struct Decay {
  double error, rate;
};
Decay decay_of(const Scene& scene, Index mode, double c, int steps) {
  const auto model = build_model(scene);
  const double lambda = model->modal->eigenvalues[mode], w = std::sqrt(lambda - c * c / 4);
  TimeOptions options = time_options(scene);
  const double end = 4 * std::numbers::pi / w;
  options.step = end / steps;
  model->velocities[mode] = 1;
  Stepper stepper(*model, options);
  const auto solver = build_solver(scene, 1);
  for (int k = 0; k < steps; ++k) stepper.accept(solver->solve(stepper.prepare(), stepper.state().warm, {}));
  const double q = stepper.state().positions[mode], v = stepper.state().velocities[mode];
  return {std::abs(q - std::exp(-c * end / 2) * std::sin(w * end) / w),
          -std::log(std::hypot(w * q, v + c * q / 2)) / end};
}

TEST_F(Modal, RayleighAndModalDampingDecayAtTheRateOfTheClosedFormToSecondOrder) {
  struct Case {
    const char *mass, *stiffness, *ratio;
    double alpha, beta, zeta;
  };
  for (const Case& damping : {Case{"3", "0", "0", 3, 0, 0}, Case{"0", "1e-4", "0", 0, 1e-4, 0},
                              Case{"0", "0", "0.02", 0, 0, 0.02}, Case{"3", "1e-5", "0.02", 3, 1e-5, 0.02}}) {
    const Scene free = scene({{"gravity", "[0, 0, 0]"},
                              {"constraints", "{}"},
                              {"output", "{}"},
                              {"time.beta", "0.25"},
                              {"time.gamma", "0.5"},
                              {"solver.tolerance.stationarity", "1e-12"},
                              {"bodies.ruler.damping.mass", damping.mass},
                              {"bodies.ruler.damping.stiffness", damping.stiffness},
                              {"bodies.ruler.modal.damping_ratio", damping.ratio}});
    const Vector lambda = build_modal_basis(free).eigenvalues;
    for (const Index mode : {0, 3}) {
      const double c = damping.alpha + damping.beta * lambda[mode] + 2 * damping.zeta * std::sqrt(lambda[mode]);
      const Decay coarse = decay_of(free, mode, c, 200), fine = decay_of(free, mode, c, 400);
      // What the steps add, above all the first, is of second order in their size and does not depend on the damping.
      const double rate = (4 * fine.rate - coarse.rate) / 3;
      std::printf(
          "alpha %s beta %s zeta %s, mode %d: rate %.6g, of steps going to zero %.6g, closed form %.6g; order %.3f\n",
          damping.mass, damping.stiffness, damping.ratio, static_cast<int>(mode + 1), fine.rate, rate, c / 2,
          std::log2(coarse.error / fine.error));
      EXPECT_NEAR(rate / (c / 2), 1, 1e-3);
      EXPECT_NEAR(std::log2(coarse.error / fine.error), 2, 0.05);
      EXPECT_NEAR((coarse.rate - c / 2) / (fine.rate - c / 2), 4, 0.2);
    }
  }
}

TEST_F(Modal, FrozenRotationsMakeTheStepLinear) {
  const Scene frozen = scene({{"bodies.ruler.modal.rotation", "predictor"}});
  RunOptions options;
  options.threads = 1;
  const RunSummary summary = run(frozen, options);
  EXPECT_EQ(summary.status, Status::solved) << summary.message;
}

TEST_F(Modal, ABasisIsSavedAndReloadedWithItsBitsAndRefusedByOthers) {
  const ModalBasis basis = build_modal_basis(scene({}, 14));
  write_basis(path("basis"), basis);
  const std::string name = path("basis").string();
  const ModalBasis again = build_modal_basis(scene({{"bodies.ruler.modal.basis", name}}));
  EXPECT_EQ(again.shapes, basis.shapes.leftCols(12));
  EXPECT_EQ(again.eigenvalues, basis.eigenvalues.head(12));
  const auto refusal = [&](Overrides overrides, int modes = 12) {
    overrides.emplace_back("bodies.ruler.modal.basis", name);
    return text_of([&] { build_modal_basis(scene(overrides, modes)); });
  };
  EXPECT_THAT(refusal({{"bodies.ruler.mesh.grid.cells", "[12,3]"}}), HasSubstr("another mesh"));
  EXPECT_THAT(refusal({{"bodies.ruler.density", "7000"}}), HasSubstr("another material"));
  EXPECT_THAT(refusal({{"bodies.ruler.modal.clamp", "{\"edges\": [\"x1\"]}"}}), HasSubstr("another material"));
  EXPECT_THAT(refusal({}, 15), HasSubstr("14 modes"));
  std::string bytes = read_bytes(path("basis"));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_atomically(path("basis"), bytes);
  EXPECT_THAT(refusal({}), HasSubstr("CRC-32"));
}

TEST_F(Modal, WhatItCannotDoIsRefused) {
  const auto refusal = [&](const Overrides& overrides) { return text_of([&] { build_model(scene(overrides)); }); };
  EXPECT_THAT(refusal({{"constraints.floor", R"({"type": "half_space", "body": "ruler", "point": [0,0,-1],
                        "normal": [0,0,1]})"}}),
              HasSubstr("/constraints/floor/type"));
  EXPECT_THAT(refusal({{"loads.wind", R"({"type": "wind", "body": "ruler", "velocity": [1,0,0]})"}}),
              HasSubstr("follows the body"));
  EXPECT_THAT(refusal({{"constraints.hand.select", "{\"corners\": [\"x0y0\"]}"}}), HasSubstr("which the modes clamp"));
  EXPECT_THAT(refusal({{"constraints.hand.select", "{\"edges\": [\"x1\"]}"},
                       {"constraints.hand.axes", "xyz"},
                       {"constraints.hand.surface", "both"}}),
              HasSubstr("at most one for each of the 12 modes"));
}

TEST_F(Modal, RecordedAccelerationsReplayToTheRunsOwnTrajectory) {
  RunOptions options;
  options.threads = 1;
  options.folder = path("out");
  options.accelerations = path("run.acc");
  ASSERT_EQ(run(scene(), options).status, Status::solved);
  const RebuiltStream rebuilt = read_stream(read_bytes(path("run.acc")));
  ASSERT_EQ(rebuilt.frames.size(), 7);
  const Vector q = RunFolder(path("out")).continuation(scene(), 0)->state.positions;
  EXPECT_LE((rebuilt.frames.back().state.q - q).norm(), 1e-12 * q.norm());
}

TEST_F(Modal, OnlyNewmarkIsRecorded) {
  RunOptions options;
  options.accelerations = path("run.acc");
  EXPECT_THAT(text_of([&] { run(scene({{"time.integrator", "bdf2"}}), options); }), HasSubstr("/time/integrator"));
}

}  // namespace
}  // namespace taut
