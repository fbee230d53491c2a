#include "solvers/augmented_lagrangian.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "constraints/obstacle.h"
#include "energies/dead_load.h"
#include "energies/hinge_bending.h"
#include "energies/membrane.h"
#include "support/meshes.h"
#include "support/problems.h"

namespace taut {
namespace {

/// One step of a small cloth held at two corners, under gravity, with limits on both sides.
struct Cloth {
  static constexpr int cells = 6;
  TriangleMesh mesh = make_grid(1, 1, cells, cells, Diagonals::alternating);
  std::vector<RestTriangle> triangles = rest_triangles(mesh.triangles, mesh.vertices);
  std::shared_ptr<Inertia> inertia =
      std::make_shared<Inertia>(Inertia::lumped("inertia", triangles, 0.15, static_cast<Index>(mesh.vertices.size())));
  OwnedProblem owned;

  explicit Cloth(double step = 0.03) {
    Problem& problem = owned.problem;
    problem.initial_guess = flatten(mesh.vertices);
    owned.pin({cells * (cells + 1), cells * (cells + 1) + cells});
    Vector fall = Vector::Zero(problem.size()), weight = fall;
    for (Index i = 2; i < problem.size(); i += 3) fall[i] = -9.81;
    inertia->add_product(fall, weight);
    inertia->set_target(1 / (step * step), problem.initial_guess);
    owned.add(std::shared_ptr<const Energy>(inertia));
    owned.add(std::make_shared<DeadLoad>("gravity", weight));
    owned.add(std::make_shared<Membrane>("membrane", triangles, MembraneLaw::stvk, Lame::plane_stress(8210, 0.243),
                                         0.318e-3));
    owned.add(std::make_shared<HingeBending>("bending", make_hinges(mesh.triangles, mesh.vertices, 2.3e-6, false)));
    owned.add(std::make_shared<MatrixStrainLimit>(limit_on(triangles, 0.9, 1.1)));
    problem.topology = new_topology();
  }
};

/// Steps of implicit Euler, each started at the last positions and multipliers.
std::vector<Result> march(Cloth& cloth, AugmentedLagrangian& solver, int steps) {
  constexpr double step = 0.03;
  std::vector<Result> results;
  WarmStart warm;
  Vector x = cloth.owned.problem.initial_guess, v = Vector::Zero(x.size());
  for (int i = 0; i < steps; ++i) {
    cloth.inertia->set_target(1 / (step * step), x + step * v);
    cloth.owned.problem.initial_guess = x;
    results.push_back(solver.solve(cloth.owned.problem, warm, {}));
    v = (results.back().x - x) / step;
    x = results.back().x;
    warm = {results.back().multipliers, results.back().penalties, 0, {}};
  }
  return results;
}

TEST(AugmentedLagrangian, SolvesStepsWithinTheTolerancesOfTheJudge) {
  Cloth cloth;
  AugmentedLagrangian solver;
  double largest = 0;
  for (const Result& result : march(cloth, solver, 20)) {
    EXPECT_EQ(result.status, Status::solved) << result.message;
    largest = std::max(largest, result.multipliers[0].lpNorm<Eigen::Infinity>());
  }
  EXPECT_GT(largest, 0.1) << "the limit never acted";
}

TEST(AugmentedLagrangian, JudgedSolvedMeansWithinTolerance) {
  Cloth cloth;
  AugmentedLagrangian solver;
  const Result result = solver.solve(cloth.owned.problem, {}, {});
  ASSERT_EQ(result.status, Status::solved);
  EXPECT_TRUE(residuals(cloth.owned.problem, result).within(Tolerances{}));
}

TEST(AugmentedLagrangian, AnalysesAndAllocatesOnceForOneTopology) {
  Cloth cloth;
  AugmentedLagrangian solver;
  const std::vector<Result> results = march(cloth, solver, 3);
  EXPECT_EQ(results[0].counts.symbolic_analyses, 1);
  EXPECT_EQ(results[0].counts.matrix_allocations, 1);
  const std::size_t bytes = solver.size().bytes;
  for (int i : {1, 2}) {
    EXPECT_EQ(results[static_cast<std::size_t>(i)].counts.symbolic_analyses, 0);
    EXPECT_EQ(results[static_cast<std::size_t>(i)].counts.matrix_allocations, 0);
  }
  EXPECT_GT(bytes, 0u);
  Cloth other;
  EXPECT_EQ(solver.solve(other.owned.problem, {}, {}).counts.symbolic_analyses, 1);
  cloth.owned.problem.topology = 0;
  EXPECT_EQ(solver.solve(cloth.owned.problem, {}, {}).counts.symbolic_analyses, 1);
  EXPECT_EQ(solver.solve(cloth.owned.problem, {}, {}).counts.symbolic_analyses, 1);
}

TEST(AugmentedLagrangian, GivesTheSameBitsTwiceAndForTwoThreads) {
  AugmentedLagrangianOptions two_threads;
  two_threads.threads = 2;
  AugmentedLagrangian solver, again, threaded(two_threads);
  Cloth a, b, c;
  const std::vector<Result> first = march(a, solver, 5), second = march(b, again, 5), third = march(c, threaded, 5);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].x, second[i].x);
    EXPECT_EQ(first[i].multipliers, second[i].multipliers);
    EXPECT_EQ(first[i].x, third[i].x);
    EXPECT_EQ(first[i].counts.linear_solves, second[i].counts.linear_solves);
  }
}

TEST(AugmentedLagrangian, DependsOnItsArgumentsOnly) {
  Cloth cloth;
  AugmentedLagrangian used, fresh;
  march(cloth, used, 4);
  const Result a = used.solve(cloth.owned.problem, {}, {}), b = fresh.solve(cloth.owned.problem, {}, {});
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.multipliers, b.multipliers);
}

TEST(AugmentedLagrangian, SaysInfeasibleWherePinsPullTheClothBeyondItsLimit) {
  const int cells = 6;
  const TriangleMesh mesh = make_grid(1, 1, cells, cells, Diagonals::alternating);
  const std::vector<RestTriangle> triangles = rest_triangles(mesh.triangles, mesh.vertices);
  OwnedProblem owned;
  const Vector uniform =
      flatten(mapped(mesh.vertices, [](const Vector3& v) { return Vector3(1.2 * v.x(), v.y(), 0); }));
  owned.problem.initial_guess = uniform;
  std::vector<int> edges;
  for (int j = 0; j <= cells; ++j) edges.insert(edges.end(), {j * (cells + 1), j * (cells + 1) + cells});
  owned.pin(edges);
  for (Index i = 0; i < uniform.size(); i += 3) {
    // Start away from the uniform state; the pins stay.
    if (std::find(owned.problem.fixed_variables.begin(), owned.problem.fixed_variables.end(), i) ==
        owned.problem.fixed_variables.end()) {
      owned.problem.initial_guess[i] = uniform[i] / 1.2;
    }
  }
  owned.add(std::make_shared<Membrane>("membrane", triangles, MembraneLaw::stvk, Lame::plane_stress(10, 0), 1.0));
  owned.add(std::make_shared<MatrixStrainLimit>(limit_on(triangles, 0, 1.05)));
  AugmentedLagrangian solver;
  const Result result = solver.solve(owned.problem, {}, {});
  EXPECT_EQ(result.status, Status::infeasible) << result.message;
  EXPECT_NEAR(residuals(owned.problem, result).violations[0].max, 0.15, 1e-5);
  EXPECT_LE((result.x - uniform).lpNorm<Eigen::Infinity>(), 1e-5);
  EXPECT_TRUE(result.multipliers[0].allFinite());
  EXPECT_LT(result.multipliers[0].lpNorm<Eigen::Infinity>(), 1e7);
  EXPECT_LT(result.counts.linear_solves, 200);
}

TEST(AugmentedLagrangian, DoesNotCallSlowMultipliersInfeasible) {
  const int cells = 6;
  const TriangleMesh mesh = make_grid(1, 1, cells, cells, Diagonals::alternating);
  const std::vector<RestTriangle> triangles = rest_triangles(mesh.triangles, mesh.vertices);
  OwnedProblem owned;
  owned.problem.initial_guess = flatten(mesh.vertices);
  std::vector<int> left;
  Vector load = Vector::Zero(owned.problem.size());
  for (int j = 0; j <= cells; ++j) {
    left.push_back(j * (cells + 1));
    load[3 * (j * (cells + 1) + cells)] = 10.0;
  }
  owned.pin(left);
  owned.add(std::make_shared<DeadLoad>("pull", load));
  owned.add(std::make_shared<Membrane>("membrane", triangles, MembraneLaw::stvk, Lame::plane_stress(1, 0), 1.0));
  owned.add(std::make_shared<MatrixStrainLimit>(limit_on(triangles, 0, 1.05)));
  // Violations fall by less than half in an update, and are not small at a thousand times these penalties either.
  AugmentedLagrangianOptions options;
  options.central_path.enabled = false;
  options.penalty = 0.1;
  options.penalty_growth = 1.1;
  EXPECT_EQ(AugmentedLagrangian(options).solve(owned.problem, {}, {}).status, Status::iteration_limit);
  options.penalty_growth = 2;
  EXPECT_EQ(AugmentedLagrangian(options).solve(owned.problem, {}, {}).status, Status::solved);
}

TEST(AugmentedLagrangian, RestsAVertexOnTheFloor) {
  OwnedProblem owned;
  owned.problem.initial_guess = Vector{{0, 0, 1}};
  const auto inertia =
      std::make_shared<Inertia>(Inertia::lumped("inertia", {{{0, 0, 0}, TriangleShape::Zero(), 2.0}}, 1.0, 1));
  inertia->set_target(100, Vector{{0.5, 0, -0.25}});
  owned.add(std::shared_ptr<const Energy>(inertia));
  owned.add(std::make_shared<HalfSpace>("floor", "ball", std::vector<int>{0}, 0, 1.0));
  AugmentedLagrangian solver;
  const Result result = solver.solve(owned.problem, {}, {});
  ASSERT_EQ(result.status, Status::solved) << result.message;
  EXPECT_LE((result.x - Vector3(0.5, 0, 0)).norm(), 1e-6);
  EXPECT_NEAR(result.multipliers[0][0], -2.0 * 100 * 0.25, 1e-3);
}

TEST(AugmentedLagrangian, SolvesWithoutConstraintsAndWithEverythingFixed) {
  Cloth cloth;
  cloth.owned.problem.constraints.clear();
  AugmentedLagrangian solver;
  EXPECT_EQ(solver.solve(cloth.owned.problem, {}, {}).status, Status::solved);

  Cloth held;
  held.owned.problem.fixed_variables.clear();
  std::vector<int> all(held.mesh.vertices.size());
  std::iota(all.begin(), all.end(), 0);
  held.owned.pin(all);
  AugmentedLagrangian other;
  const Result result = other.solve(held.owned.problem, {}, {});
  EXPECT_EQ(result.status, Status::solved) << result.message;
  EXPECT_EQ(result.x, held.owned.problem.initial_guess);
}

TEST(AugmentedLagrangian, PutsFixedVariablesWhereTheProblemSays) {
  Cloth cloth;
  cloth.owned.problem.fixed_values.array() += 0.01;
  AugmentedLagrangian solver;
  const Result result = solver.solve(cloth.owned.problem, {}, {});
  for (std::size_t i = 0; i < cloth.owned.problem.fixed_variables.size(); ++i) {
    EXPECT_EQ(result.x[cloth.owned.problem.fixed_variables[i]],
              cloth.owned.problem.fixed_values[static_cast<Index>(i)]);
  }
}

/// (x - 1)^2 of one vertex whose value, gradient or Hessian turns into NaN.
class Broken final : public Energy {
 public:
  enum class Part { value, gradient, hessian };
  explicit Broken(Part part) : part_(part) { stencils_.add_vertices(std::array{0}); }
  std::string name() const override { return "broken"; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index /*element*/, const double* x, double* gradient, double* hessian,
                  Curvature /*curvature*/) const override {
    const Vector3 off = Eigen::Map<const Vector3>(x) - Vector3::Ones();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    if (gradient) Eigen::Map<Vector3>{gradient} = part_ == Part::gradient ? Vector3(nan, 0, 0) : Vector3(2 * off);
    if (hessian) Eigen::Map<Matrix3>{hessian} = (part_ == Part::hessian ? nan : 2.0) * Matrix3::Identity();
    return part_ == Part::value ? nan : off.squaredNorm();
  }

 private:
  Part part_;
  Stencils stencils_{3};
};

TEST(AugmentedLagrangian, NeverCallsANanSolved) {
  for (Broken::Part part : {Broken::Part::value, Broken::Part::gradient, Broken::Part::hessian}) {
    OwnedProblem owned;
    owned.problem.initial_guess = Vector::Zero(3);
    owned.add(std::make_shared<Broken>(part));
    AugmentedLagrangian solver;
    EXPECT_EQ(solver.solve(owned.problem, {}, {}).status, Status::not_finite) << static_cast<int>(part);
  }
  Cloth cloth;
  cloth.owned.problem.initial_guess[5] = std::numeric_limits<double>::quiet_NaN();
  AugmentedLagrangian solver;
  EXPECT_EQ(solver.solve(cloth.owned.problem, {}, {}).status, Status::not_finite);
}

TEST(AugmentedLagrangian, StopsOnRequestAndOnTime) {
  Cloth cloth;
  AugmentedLagrangian solver;
  const std::atomic<bool> stop{true};
  Budget budget;
  budget.stop = &stop;
  EXPECT_EQ(solver.solve(cloth.owned.problem, {}, budget).status, Status::interrupted);
  budget = {};
  budget.deadline = std::chrono::steady_clock::now();
  EXPECT_EQ(solver.solve(cloth.owned.problem, {}, budget).status, Status::time_limit);
}

TEST(AugmentedLagrangian, SaysWhenItsIterationsAreUsedUp) {
  Cloth cloth;
  AugmentedLagrangianOptions options;
  options.tolerances = {1e-15, 1e-15, 1e-15};
  options.max_newton = 2;
  AugmentedLagrangian solver(options);
  EXPECT_EQ(solver.solve(cloth.owned.problem, {}, {}).status, Status::iteration_limit);
}

TEST(AugmentedLagrangian, RejectsProblemsAndOptionsThatDoNotFit) {
  Cloth cloth;
  cloth.owned.problem.fixed_values.resize(1);
  AugmentedLagrangian solver;
  EXPECT_THROW(solver.solve(cloth.owned.problem, {}, {}), std::invalid_argument);
  AugmentedLagrangianOptions options;
  options.penalty = 0;
  EXPECT_THROW(AugmentedLagrangian{options}, std::invalid_argument);
  options = {};
  options.inner_tolerance_factor = 1;
  EXPECT_THROW(AugmentedLagrangian{options}, std::invalid_argument);
}

}  // namespace
}  // namespace taut
