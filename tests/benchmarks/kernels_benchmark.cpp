// What one element, one assembly and one factorisation cost. The counter `per_element` is seconds (n: nanoseconds) per
// element or triangle. Cloth is crumpled by a tenth of a cell, so that about half of the triangles are beyond a limit.

#include <benchmark/benchmark.h>

#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <deque>
#include <stdexcept>
#include <vector>

#include "benchmarks/scene_h.h"
#include "core/assembly.h"
#include "dynamics/stepper.h"
#include "energies/hinge_bending.h"
#include "energies/membrane.h"
#include "energies/prism_shell.h"
#include "geometry/grid.h"
#include "geometry/layered_mesh.h"
#include "linalg/cholesky.h"
#include "linalg/svd3x2.h"
#include "problems/build.h"
#include "solvers/eliminated_slack.h"

namespace taut::benchmarks {
namespace {

using Linearisation = EliminatedSlack::Linearisation;

constexpr int kernel_cells = 16;
constexpr Limit limit{0.9, 1.1};
constexpr double epsilon = 1e-8;  ///< the central path's smoothing

/// A first time step of scene H with the constraints' slacks as energies, as the solver sees it.
struct PosedStep {
  explicit PosedStep(int cells, const std::string& membrane_law = "stvk")
      : scene(scene_h(cells, limit, membrane_law)),
        model(build_model(scene)),
        stepper(*model, time_options(scene)),
        problem(stepper.prepare()),
        x(crumpled(*model, cells)) {
    for (const Constraint* constraint : problem.constraints) {
      slacks.emplace_back(*constraint);
      slacks.back().set_penalty(1.0);
    }
  }
  std::vector<const Energy*> energies() const {
    std::vector<const Energy*> all = problem.energies;
    for (const EliminatedSlack& slack : slacks) all.push_back(&slack);
    return all;
  }
  template <class Wanted>
  const Wanted& energy() const {
    for (const auto& elastic : model->elastic) {
      if (const auto* found = dynamic_cast<const Wanted*>(elastic.get())) return *found;
    }
    throw std::logic_error("scene H has no such energy");
  }
  double triangles() const { return static_cast<double>(model->triangles.size()); }

  Scene scene;
  std::unique_ptr<Model> model;
  Stepper stepper;
  const Problem& problem;
  Vector x;
  std::deque<EliminatedSlack> slacks;
};

void count_elements(benchmark::State& state, double elements) {
  state.counters["per_element"] =
      benchmark::Counter(elements, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

enum class Wanted { value, gradient, hessian, exact_hessian };

void evaluate_all(benchmark::State& state, const Energy& energy, const Vector& x, Wanted wanted) {
  const Stencils& stencils = energy.stencils();
  const int width = stencils.width();
  std::vector<double> locals(stencils.count() * width);
  for (Index e = 0; e < stencils.count(); ++e) stencils.gather(e, x, locals.data() + e * width);
  std::array<double, max_stencil_width> gradient;
  std::array<double, max_stencil_width * max_stencil_width> hessian;
  double* const to_gradient = wanted == Wanted::value ? nullptr : gradient.data();
  double* const to_hessian = wanted <= Wanted::gradient ? nullptr : hessian.data();
  const Curvature curvature = wanted == Wanted::exact_hessian ? Curvature::exact : Curvature::positive_semidefinite;
  for (auto _ : state) {
    for (Index e = 0; e < stencils.count(); ++e) {
      benchmark::DoNotOptimize(energy.evaluate(e, locals.data() + e * width, to_gradient, to_hessian, curvature));
      benchmark::ClobberMemory();
    }
  }
  count_elements(state, static_cast<double>(stencils.count()));
}

void membrane(benchmark::State& state, const char* law, Wanted wanted) {
  const PosedStep step(kernel_cells, law);
  evaluate_all(state, step.energy<Membrane>(), step.x, wanted);
}
BENCHMARK_CAPTURE(membrane, stvk_gradient, "stvk", Wanted::gradient);
BENCHMARK_CAPTURE(membrane, stvk_hessian, "stvk", Wanted::hessian);
BENCHMARK_CAPTURE(membrane, neo_hookean_gradient, "neo_hookean", Wanted::gradient);
BENCHMARK_CAPTURE(membrane, neo_hookean_hessian, "neo_hookean", Wanted::hessian);

/// A plate of prisms, two a cell, bent by noise of a hundredth of its thickness.
struct PosedPlate {
  PosedPlate(int cells, PrismElement element, SolidLaw law)
      : layered(make_layered(make_grid(1, 1, cells, cells, Diagonals::alternating), std::vector{0.01}, {1.0}, "plate")),
        shell("shell", rest_prisms(layered.prisms, layered.nodes), SolidMaterial::isotropic(law, 1e6, 0.3),
              options(element)),
        x(3 * static_cast<Index>(layered.nodes.size())) {
    for (std::size_t node = 0; node < layered.nodes.size(); ++node) {
      const double at = static_cast<double>(node);
      const Vector3 noise(std::sin(1.0 * at), std::sin(2.0 * at), std::sin(3.0 * at));
      x.segment<3>(3 * static_cast<Index>(node)) = layered.nodes[node] + 1e-4 * noise;
    }
  }
  static PrismShellOptions options(PrismElement element) {
    PrismShellOptions made;
    made.element = element;
    return made;
  }
  LayeredMesh layered;
  PrismShell shell;
  Vector x;
};

void prism(benchmark::State& state, PrismElement element, SolidLaw law, Wanted wanted) {
  const PosedPlate plate(kernel_cells, element, law);
  evaluate_all(state, plate.shell, plate.x, wanted);
}
BENCHMARK_CAPTURE(prism, stvk_gradient, PrismElement::assumed_strain, SolidLaw::stvk, Wanted::gradient);
BENCHMARK_CAPTURE(prism, stvk_hessian, PrismElement::assumed_strain, SolidLaw::stvk, Wanted::hessian);
BENCHMARK_CAPTURE(prism, stvk_exact_hessian, PrismElement::assumed_strain, SolidLaw::stvk, Wanted::exact_hessian);
BENCHMARK_CAPTURE(prism, stvk_plain_exact_hessian, PrismElement::plain, SolidLaw::stvk, Wanted::exact_hessian);
BENCHMARK_CAPTURE(prism, neo_hookean_gradient, PrismElement::assumed_strain, SolidLaw::neo_hookean, Wanted::gradient);
BENCHMARK_CAPTURE(prism, neo_hookean_hessian, PrismElement::assumed_strain, SolidLaw::neo_hookean, Wanted::hessian);
BENCHMARK_CAPTURE(prism, neo_hookean_exact_hessian, PrismElement::assumed_strain, SolidLaw::neo_hookean,
                  Wanted::exact_hessian);

void hinge(benchmark::State& state, Wanted wanted) {
  const PosedStep step(kernel_cells);
  evaluate_all(state, step.energy<HingeBending>(), step.x, wanted);
}
BENCHMARK_CAPTURE(hinge, gradient, Wanted::gradient);
BENCHMARK_CAPTURE(hinge, hessian, Wanted::hessian);
BENCHMARK_CAPTURE(hinge, exact_hessian, Wanted::exact_hessian);

void strain_limit(benchmark::State& state, Linearisation linearisation, Wanted wanted) {
  PosedStep step(kernel_cells);
  EliminatedSlack& slack = step.slacks.front();
  slack.set_point(step.x, epsilon, 1);
  slack.set_linearisation(linearisation);
  evaluate_all(state, slack, step.x, wanted);
}
BENCHMARK_CAPTURE(strain_limit, multipliers_gradient, Linearisation::augmented_lagrangian, Wanted::gradient);
BENCHMARK_CAPTURE(strain_limit, multipliers_hessian, Linearisation::augmented_lagrangian, Wanted::hessian);
BENCHMARK_CAPTURE(strain_limit, path_hessian, Linearisation::central_path, Wanted::hessian);
BENCHMARK_CAPTURE(strain_limit, path_gradient, Linearisation::central_path, Wanted::gradient);

void strain_limit_path_point(benchmark::State& state) {
  PosedStep step(kernel_cells);
  for (auto _ : state) benchmark::DoNotOptimize(step.slacks.front().set_point(step.x, epsilon, 1).max);
  count_elements(state, step.triangles());
}
BENCHMARK(strain_limit_path_point);

void strain_limit_path_aim(benchmark::State& state) {
  PosedStep step(kernel_cells);
  EliminatedSlack& slack = step.slacks.front();
  slack.set_point(step.x, epsilon, 1);
  Vector gradient = Vector::Zero(step.x.size());
  for (auto _ : state) slack.aim(epsilon, 1, gradient);
  count_elements(state, step.triangles());
}
BENCHMARK(strain_limit_path_aim);

void strain_limit_path_multiplier_step(benchmark::State& state) {
  PosedStep step(kernel_cells);
  EliminatedSlack& slack = step.slacks.front();
  slack.set_point(step.x, epsilon, 1);
  Vector gradient = Vector::Zero(step.x.size());
  slack.aim(epsilon, 1, gradient);
  const Vector dx = step.x - step.model->positions;
  Vector change;
  for (auto _ : state) {
    slack.multiplier_step(dx, 1, change);
    benchmark::DoNotOptimize(change.data());
  }
  count_elements(state, step.triangles());
}
BENCHMARK(strain_limit_path_multiplier_step);

std::vector<Matrix32> deformation_gradients() {
  const PosedStep step(kernel_cells);
  const Membrane& energy = step.energy<Membrane>();
  std::vector<Matrix32> all;
  std::array<double, 9> local;
  for (std::size_t e = 0; e < energy.triangles().size(); ++e) {
    energy.stencils().gather(static_cast<Index>(e), step.x, local.data());
    all.push_back(energy.triangles()[e].deformation_gradient(local.data()));
  }
  return all;
}

void svd_closed_form(benchmark::State& state) {
  const std::vector<Matrix32> all = deformation_gradients();
  for (auto _ : state) {
    for (const Matrix32& f : all) benchmark::DoNotOptimize(svd(f));
  }
  count_elements(state, static_cast<double>(all.size()));
}
BENCHMARK(svd_closed_form);

void svd_eigen_jacobi(benchmark::State& state) {
  const std::vector<Matrix32> all = deformation_gradients();
  for (auto _ : state) {
    for (const Matrix32& f : all) {
      const Eigen::JacobiSVD<Matrix32> decomposition(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
      benchmark::DoNotOptimize(decomposition.singularValues().data());
      benchmark::ClobberMemory();
    }
  }
  count_elements(state, static_cast<double>(all.size()));
}
BENCHMARK(svd_eigen_jacobi);

/// In the order that the factorisation wants, as in a solve.
Assembly assembly_of(const PosedStep& step, int threads) {
  Assembly assembly(step.problem.size(), step.energies(), step.problem.fixed_variables, threads);
  assembly.set_order(fill_reducing_order(assembly.graph()));
  return assembly;
}

void assembly_gradient(benchmark::State& state) {
  const PosedStep step(static_cast<int>(state.range(0)));
  const Assembly assembly = assembly_of(step, static_cast<int>(state.range(1)));
  Vector gradient;
  for (auto _ : state) benchmark::DoNotOptimize(assembly.gradient(step.x, gradient));
  count_elements(state, step.triangles());
}
BENCHMARK(assembly_gradient)->ArgNames({"cells", "threads"})->ArgsProduct({{64, 128}, {1, 2}})->UseRealTime();

void assembly_hessian(benchmark::State& state, Linearisation linearisation) {
  PosedStep step(static_cast<int>(state.range(0)));
  for (EliminatedSlack& slack : step.slacks) {
    slack.set_linearisation(linearisation);
    slack.set_point(step.x, epsilon, 1);
  }
  Assembly assembly = assembly_of(step, static_cast<int>(state.range(1)));
  Vector gradient;
  for (auto _ : state) {
    assembly.hessian(step.x, Curvature::positive_semidefinite, &gradient);
    benchmark::ClobberMemory();
  }
  count_elements(state, step.triangles());
}
BENCHMARK_CAPTURE(assembly_hessian, multipliers, Linearisation::augmented_lagrangian)
    ->ArgNames({"cells", "threads"})
    ->ArgsProduct({{64, 128}, {1, 2}})
    ->UseRealTime();
BENCHMARK_CAPTURE(assembly_hessian, path, Linearisation::central_path)
    ->ArgNames({"cells", "threads"})
    ->ArgsProduct({{64, 128}, {1, 2}})
    ->UseRealTime();

/// The plate held at one side, in the order of a solve.
Assembly assembly_of(const PosedPlate& plate, int cells) {
  std::vector<int> fixed;
  for (int i = 0; i < 6 * (cells + 1); ++i) fixed.push_back(i);
  Assembly assembly(plate.x.size(), {&plate.shell}, fixed, 1);
  assembly.set_order(fill_reducing_order(assembly.graph()));
  return assembly;
}

void prism_assembly_hessian(benchmark::State& state, SolidLaw law) {
  const int cells = static_cast<int>(state.range(0));
  const PosedPlate plate(cells, PrismElement::assumed_strain, law);
  Assembly assembly = assembly_of(plate, cells);
  Vector gradient;
  for (auto _ : state) {
    assembly.hessian(plate.x, Curvature::positive_semidefinite, &gradient);
    benchmark::ClobberMemory();
  }
  count_elements(state, static_cast<double>(plate.layered.prisms.size()));
}
BENCHMARK_CAPTURE(prism_assembly_hessian, stvk, SolidLaw::stvk)
    ->ArgName("cells")
    ->Arg(128)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(prism_assembly_hessian, neo_hookean, SolidLaw::neo_hookean)
    ->ArgName("cells")
    ->Arg(128)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void prism_factorize_and_solve(benchmark::State& state) {
  const int cells = static_cast<int>(state.range(0));
  const PosedPlate plate(cells, PrismElement::assumed_strain, SolidLaw::stvk);
  Assembly assembly = assembly_of(plate, cells);
  Vector gradient, right_hand_side, solution;
  assembly.hessian(plate.x, Curvature::positive_semidefinite, &gradient);
  assembly.to_ordered(gradient, right_hand_side);
  Cholesky cholesky(assembly.matrix(), 1);
  for (auto _ : state) {
    if (!cholesky.factorize(assembly.matrix())) {
      state.SkipWithError("the matrix is not positive definite");
      break;
    }
    cholesky.solve(right_hand_side, solution);
    benchmark::DoNotOptimize(solution.data());
  }
  state.counters["factor_nonzeros"] = cholesky.factor_nonzeros();
}
BENCHMARK(prism_factorize_and_solve)->ArgName("cells")->Arg(128)->UseRealTime()->Unit(benchmark::kMillisecond);

/// Numeric factorisation and one pair of triangular solves: what no Newton iteration can do without.
void factorize_and_solve(benchmark::State& state) {
  const PosedStep step(static_cast<int>(state.range(0)));
  Assembly assembly = assembly_of(step, 1);
  Vector gradient, right_hand_side, solution;
  assembly.hessian(step.x, Curvature::positive_semidefinite, &gradient);
  assembly.to_ordered(gradient, right_hand_side);
  Cholesky cholesky(assembly.matrix(), static_cast<int>(state.range(1)));
  for (auto _ : state) {
    if (!cholesky.factorize(assembly.matrix())) {
      state.SkipWithError("the matrix is not positive definite");
      break;
    }
    cholesky.solve(right_hand_side, solution);
    benchmark::DoNotOptimize(solution.data());
  }
  count_elements(state, step.triangles());
  state.counters["factor_nonzeros"] = cholesky.factor_nonzeros();
  state.counters["gigaflops"] =
      benchmark::Counter(cholesky.factor_flops() * 1e-9, benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(factorize_and_solve)
    ->ArgNames({"cells", "threads"})
    ->ArgsProduct({{32, 64}, {1}})
    ->ArgsProduct({{128, 256}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace taut::benchmarks
