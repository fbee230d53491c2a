// A step of a ruler of 300 x 30 x 1 mm in 50 modes with 12 held coordinates, and the same step of the full thick shell.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "dynamics/modal/modal_integrator.h"
#include "problems/build.h"
#include "problems/read_scene.h"

namespace taut::benchmarks {
namespace {

Scene ruler(const std::string& model, double gravity = -9.81) {
  const auto file = std::filesystem::temp_directory_path() / ("taut_benchmark_" + model + ".json");
  const bool modal = model == "modal";
  std::ofstream(file) << fmt::format(
      R"({{
    "format": 1, "time": {{ "integrator": "newmark", "step": 0.002, "steps": 1000 }}, "gravity": [0, 0, {}],
    "bodies": {{ "ruler": {{ "model": "{}", "mesh": {{ "grid": {{ "size": [0.3, 0.03], "cells": [40, 4] }} }},
      "thickness": 0.001, "density": 7850, "mass": "consistent",
      "material": {{ "law": "stvk", "young_modulus": 2e11, "poisson_ratio": 0.3 }} {} }} }},
    "constraints": {{ {} "hand": {{ "type": "pin", "body": "ruler",
      "select": {{ "corners": ["x1y0", "x1y1"] }}, "surface": "both",
      "motion": {{ "velocity": [0, 0, 0.01] }} }} }} }})",
      gravity, model, modal ? R"(, "modal": { "modes": 50, "clamp": { "edges": ["x0"] } })" : "",
      modal ? "" : R"("clamp": { "type": "pin", "body": "ruler", "select": { "edges": ["x0"] } },)");
  return read_scene(file);
}

void BM_modal_step(benchmark::State& state) {
  auto basis = std::make_shared<ModalBasis>(build_modal_basis(ruler("modal")));
  std::vector<WarpedPosition::Held> held;  // both ends of the tip, bottom and top
  for (const int node : {80, 81, 408, 409}) {
    for (int axis = 0; axis < 3; ++axis) held.push_back({node, axis});
  }
  ModalIntegrator body(basis, {0.002, 0.3025, 0.6}, Vector::Zero(50), held);
  Vector targets(12);
  for (int k = 0; k < 12; ++k) targets[k] = basis->rest[3 * held[k].node + held[k].axis];
  const Vector force = Vector::Zero(50);
  for (auto unused : state) {
    for (int k = 2; k < 12; k += 3) targets[k] += 1e-9;
    body.step(force, targets);
  }
  if (!body.state().q.allFinite()) state.SkipWithError("not finite");
}
BENCHMARK(BM_modal_step)->Unit(benchmark::kMicrosecond);

void steps_of(benchmark::State& state, const std::string& model, double gravity = -9.81) {
  const Scene scene = ruler(model, gravity);
  const auto body = build_model(scene);
  const auto solver = build_solver(scene, 1);
  Stepper stepper(*body, time_options(scene));
  for (auto unused : state) {
    const Result result = solver->solve(stepper.prepare(), stepper.state().warm, {});
    if (result.status != Status::solved) return state.SkipWithError(result.message.c_str());
    stepper.accept(result);
  }
}
void BM_modal_step_as_problem(benchmark::State& state) { steps_of(state, "modal"); }
void BM_modal_step_as_problem_without_gravity(benchmark::State& state) { steps_of(state, "modal", 0); }
void BM_full_shell_step(benchmark::State& state) { steps_of(state, "thick_shell"); }
BENCHMARK(BM_modal_step_as_problem)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_modal_step_as_problem_without_gravity)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_full_shell_step)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace taut::benchmarks
