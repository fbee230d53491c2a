#include "dynamics/stepper.h"

#include <gtest/gtest.h>

#include "tests/dynamics/small_models.h"

namespace taut {
namespace {

TimeOptions options_of(Integrator integrator, double step, int steps, double spectral_radius = 0.8) {
  return {integrator, step, steps, spectral_radius};
}

constexpr Integrator dynamic_integrators[] = {Integrator::implicit_euler, Integrator::bdf2,
                                              Integrator::generalised_alpha};

double sum_of(const std::vector<std::pair<std::string, double>>& energies) {
  double sum = 0;
  for (const auto& [name, value] : energies) sum += value;
  return sum;
}

Model falling_patch(bool consistent) {
  const TriangleMesh mesh = make_grid(1, 1, 2, 2, Diagonals::left);
  Model model = model_of(mesh, consistent);
  add_membrane(mesh, model);
  add_gravity({0, 0, -10}, model);
  for (Index v = 0; v < 9; ++v) model.velocities.segment<3>(3 * v) = Vector3(1, 0, 2);
  return model;
}

TEST(FreeFall, IsExactInTheIntegratorsOfSecondOrder) {
  for (const bool consistent : {false, true}) {
    for (const Integrator integrator : {Integrator::bdf2, Integrator::generalised_alpha}) {
      Model model = falling_patch(consistent);
      Stepper stepper(model, options_of(integrator, 0.05, 10));
      auto solver = tight_solver();
      const double energy = sum_of(stepper.energies());
      advance(stepper, solver, 10);
      for (Index v = 0; v < 9; ++v) {
        const Vector3 moved = stepper.state().positions.segment<3>(3 * v) - model.positions.segment<3>(3 * v);
        EXPECT_LT((moved - Vector3(0.5, 0, 2 * 0.5 - 5 * 0.25)).norm(), 1e-10);
        EXPECT_LT((stepper.state().velocities.segment<3>(3 * v) - Vector3(1, 0, 2 - 10 * 0.5)).norm(), 1e-9);
      }
      EXPECT_NEAR(sum_of(stepper.energies()), energy, 1e-9) << "kinetic, membrane and gravity";
    }
  }
}

TEST(FreeFall, IsExactInVelocityAndHalfAStepAheadInPositionWithImplicitEuler) {
  Model model = falling_patch(false);
  Stepper stepper(model, options_of(Integrator::implicit_euler, 0.05, 10));
  auto solver = tight_solver();
  advance(stepper, solver, 10);
  const Vector3 moved = stepper.state().positions.head<3>() - model.positions.head<3>();
  EXPECT_LT((moved - Vector3(0.5, 0, 2 * 0.5 - 5 * 0.5 * (0.5 + 0.05))).norm(), 1e-10);
  EXPECT_LT((stepper.state().velocities.head<3>() - Vector3(1, 0, -3)).norm(), 1e-9);
}

TEST(Momentum, OfAFreeVibrationIsKeptByEveryIntegrator) {
  for (const Integrator integrator : dynamic_integrators) {
    Model model = vibrating_patch();
    model.pins.clear();
    Stepper stepper(model, options_of(integrator, 0.1, 20));
    const auto momentum = [&] {
      Vector product = Vector::Zero(model.positions.size());
      model.inertia[0]->add_product(stepper.state().velocities, product);
      return Vector3(Eigen::Map<const Eigen::Matrix3Xd>(product.data(), 3, product.size() / 3).rowwise().sum());
    };
    const Vector3 start = momentum();
    auto solver = tight_solver();
    advance(stepper, solver, 20);
    EXPECT_GT((stepper.state().velocities - model.velocities).norm(), 0.1) << "it should have vibrated";
    EXPECT_LT((momentum() - start).norm(), 1e-9) << static_cast<int>(integrator);
  }
}

TEST(ImplicitEuler, LosesEnergyWhereAverageAccelerationKeepsIt) {
  const auto energy_left = [](Integrator integrator) {
    Model model = vibrating_patch();
    Stepper stepper(model, options_of(integrator, 0.05, 100, 1.0));
    const double start = sum_of(stepper.energies());
    auto solver = tight_solver(1e-9);
    advance(stepper, solver, 100);
    return sum_of(stepper.energies()) / start;
  };
  EXPECT_LT(energy_left(Integrator::implicit_euler), 0.8);
  EXPECT_NEAR(energy_left(Integrator::generalised_alpha), 1.0, 0.02);
}

TEST(Pins, LandOnTheirScriptsToTheLastBit) {
  for (const Integrator integrator :
       {Integrator::implicit_euler, Integrator::bdf2, Integrator::generalised_alpha, Integrator::quasi_static}) {
    Model model = vibrating_patch();
    model.pins.clear();
    for (int v = 0; v < 3; ++v)
      pin(v, model, [v](double t) { return Vector3(0.1 * std::sin(3 * t + v), -0.2 * t, 1.0 / 3.0 * t * t); });
    Stepper stepper(model, options_of(integrator, 1.0 / 7, 7));
    auto solver = tight_solver(1e-9);
    for (int k = 1; k <= 7; ++k) {
      advance(stepper, solver, 1);
      for (const PinnedVariable& held : model.pins)
        EXPECT_EQ(stepper.state().positions[held.variable], held.value(stepper.time()));
    }
    if (integrator == Integrator::quasi_static) {
      EXPECT_EQ(stepper.time(), 1.0);
    }
  }
}

TEST(Pins, TakeTheirVelocityFromTheScriptAndDoNotRingAfterAKink) {
  for (const Integrator integrator : dynamic_integrators) {
    Model model = vibrating_patch(true);
    model.pins.clear();
    for (int v = 0; v < 3; ++v) pin(v, model, [](double t) { return Vector3(2 * std::min(t, 0.35), 0, 0); });
    Stepper stepper(model, options_of(integrator, 0.1, 6, 1.0));
    EXPECT_NEAR(stepper.state().velocities[0], 2, 1e-12);
    auto solver = tight_solver(1e-9);
    advance(stepper, solver, 2);
    EXPECT_NEAR(stepper.state().velocities[0], 2, 1e-12) << static_cast<int>(integrator);
    advance(stepper, solver, 3);
    EXPECT_EQ(stepper.state().velocities[0], 0) << static_cast<int>(integrator);
    EXPECT_EQ(stepper.state().accelerations[0], 0) << static_cast<int>(integrator);
  }
}

TEST(Restore, ContinuesWithTheSameBits) {
  const auto make = [] {
    Model model = vibrating_patch();
    model.mass_damping = {0.1};
    add_gravity({0, 20, -2}, model);
    add_limit(patch_mesh(), 0.5, 1.3, model);
    return model;
  };
  for (const Integrator integrator :
       {Integrator::implicit_euler, Integrator::bdf2, Integrator::generalised_alpha, Integrator::quasi_static}) {
    const TimeOptions options = options_of(integrator, 0.04, 6);
    Model whole = make(), first = make(), second = make();
    auto solver = tight_solver(1e-8), first_solver = tight_solver(1e-8), second_solver = tight_solver(1e-8);
    Stepper uninterrupted(whole, options), before(first, options), after(second, options);
    advance(uninterrupted, solver, 6);
    advance(before, first_solver, 3);
    after.restore(before.state());
    advance(after, second_solver, 3);
    EXPECT_EQ(after.state().step, 6);
    EXPECT_TRUE(after.state().positions == uninterrupted.state().positions) << static_cast<int>(integrator);
    EXPECT_TRUE(after.state().velocities == uninterrupted.state().velocities) << static_cast<int>(integrator);
    EXPECT_TRUE(after.state().accelerations == uninterrupted.state().accelerations) << static_cast<int>(integrator);
    EXPECT_GT(after.state().warm.multipliers[0].lpNorm<Eigen::Infinity>(), 0.1) << "the limit should be active";
    EXPECT_TRUE(after.state().warm.multipliers[0] == uninterrupted.state().warm.multipliers[0])
        << static_cast<int>(integrator);
  }
}

TEST(Restore, RefusesAStateOfAnotherModel) {
  Model model = vibrating_patch(), other = pendulum(1.0);
  Stepper stepper(model, {}), other_stepper(other, {});
  EXPECT_THROW(stepper.restore(other_stepper.state()), std::invalid_argument);
}

/// A trampoline that is pulled wide while loads and a pressure grow.
TEST(QuasiStatic, EndStateDoesNotDependOnTheNumberOfLoadSteps) {
  const auto end_state = [](int steps) {
    const TriangleMesh mesh = make_grid(1, 1, 4, 4, Diagonals::alternating);
    Model model = model_of(mesh);
    add_membrane(mesh, model, 20);
    add_gravity({0, 0, -1}, model);
    model.pressures.push_back(std::make_unique<Pressure>("pressure", mesh.triangles, -0.5));
    for (int v = 0; v < 25; ++v) {
      const int i = v % 5, j = v / 5;
      if (i % 4 != 0 && j % 4 != 0) continue;
      pin(v, model, [=](double t) { return Vector3(0.05 * (i - 2) * t, 0.02 * (j - 2) * t, 0); });
    }
    model.velocities.setConstant(3);  // of no account
    Stepper stepper(model, options_of(Integrator::quasi_static, 1.0 / steps, steps));
    auto solver = tight_solver();
    advance(stepper, solver, steps);
    EXPECT_TRUE(stepper.state().velocities.isZero(0));
    EXPECT_EQ(stepper.state().positions[0], -0.1);
    return stepper.state().positions;
  };
  const Vector one = end_state(1);
  EXPECT_LT(one[3 * 12 + 2], -0.02) << "loads should press the middle down";
  for (const int steps : {2, 7}) EXPECT_LT((end_state(steps) - one).lpNorm<Eigen::Infinity>(), 1e-8) << steps;
}

TEST(LaggedLoads, AreEvaluatedAtTheStartOfTheStep) {
  Model model = falling_patch(false);
  const Index size = model.positions.size();
  std::vector<Vector> seen;
  model.lagged_loads.push_back(
      {std::make_unique<DeadLoad>("wind", Vector::Zero(size), true), [&](const Vector& x, const Vector& v, Vector& f) {
         seen = {x, v};
         f.array() += 0.5;
       }});
  Stepper stepper(model, options_of(Integrator::implicit_euler, 0.1, 2));
  auto solver = tight_solver();
  advance(stepper, solver, 1);
  EXPECT_TRUE(seen[0] == model.positions);
  EXPECT_TRUE(seen[1] == model.velocities);
  EXPECT_GT(stepper.state().velocities[1], 0.1) << "the load should have acted";
  const State state = stepper.state();
  stepper.prepare();
  EXPECT_TRUE(seen[0] == state.positions);
  EXPECT_TRUE(seen[1] == state.velocities);
}

TEST(Obstacles, AreWhereTheirScriptsHaveThemAtTheEndOfTheStep) {
  Model model = vibrating_patch();
  double placed = -1;
  model.movers.push_back([&](double time) { placed = time; });
  Stepper stepper(model, options_of(Integrator::implicit_euler, 0.25, 4));
  EXPECT_EQ(placed, 0);
  stepper.prepare();
  EXPECT_EQ(placed, 0.25);
  State state = stepper.state();
  state.step = 3;
  stepper.restore(state);
  EXPECT_EQ(placed, 0.75);
}

TEST(Prepare, KeepsTheTopologySoThatNothingIsAnalysedTwice) {
  Model model = vibrating_patch();
  Stepper stepper(model, options_of(Integrator::bdf2, 0.05, 3));
  auto solver = tight_solver(1e-8);
  const Problem& first = stepper.prepare();
  const auto topology = first.topology;
  EXPECT_NE(topology, 0u);
  for (int k = 0; k < 3; ++k) {
    const Problem& problem = stepper.prepare();
    EXPECT_EQ(&problem, &first);
    EXPECT_EQ(problem.topology, topology);
    const Result result = solver.solve(problem, stepper.state().warm, Budget{});
    EXPECT_EQ(result.counts.symbolic_analyses, k == 0 ? 1 : 0);
    stepper.accept(result);
  }
}

/// A velocity along the rod of a rigid pendulum cannot last; what the multipliers make of it tells the integrators
/// apart.
TEST(ConstraintForces, RingForEverWithAverageAccelerationAndSettleOtherwise) {
  const auto ringing = [](Integrator integrator, double spectral_radius) {
    Model model = pendulum(0.3);
    model.velocities.tail<3>() = Vector3(0, -1e-2 * std::sin(0.3), 1e-2 * std::cos(0.3));
    Stepper stepper(model, options_of(integrator, 0.01, 80, spectral_radius));
    auto solver = tight_solver(1e-9);
    advance(stepper, solver, 77);
    std::vector<double> tension;
    for (int k = 0; k < 3; ++k) {
      advance(stepper, solver, 1);
      tension.push_back(stepper.state().warm.multipliers[0][2]);
    }
    return std::abs(tension[0] - 2 * tension[1] + tension[2]) / std::abs(tension[0] + 2 * tension[1] + tension[2]);
  };
  const double average = ringing(Integrator::generalised_alpha, 1.0);
  EXPECT_GT(average, 0.1);
  EXPECT_LT(ringing(Integrator::generalised_alpha, 0.8), 0.01 * average);
  EXPECT_LT(ringing(Integrator::bdf2, 0), 0.01 * average);
  EXPECT_LT(ringing(Integrator::implicit_euler, 0), 0.01 * average);
}

TEST(Misuse, IsNamed) {
  Model model = vibrating_patch();
  EXPECT_THROW(Stepper(model, options_of(Integrator::bdf2, 0, 1)), std::invalid_argument);
  EXPECT_THROW(Stepper(model, options_of(Integrator::bdf2, 0.1, 0)), std::invalid_argument);
  EXPECT_THROW(Stepper(model, options_of(Integrator::generalised_alpha, 0.1, 1, 1.1)), std::invalid_argument);
  Stepper stepper(model, options_of(Integrator::bdf2, 0.1, 1));
  EXPECT_THROW(stepper.accept(Result{}), std::invalid_argument);
  model.mass_damping.clear();
  EXPECT_THROW(Stepper(model, options_of(Integrator::bdf2, 0.1, 1)), std::invalid_argument);
}

}  // namespace
}  // namespace taut
