#include <gtest/gtest.h>

#include <array>
#include <functional>

#include "tests/dynamics/small_models.h"

namespace taut {
namespace {

struct Motion {
  Vector positions, velocities;
};

/// Forces of the elastic energies, and of stiffness damping, at positions and velocities.
Vector forces(const Model& model, const Vector& x, const Vector& v) {
  std::array<double, max_stencil_width> local, moving, gradient;
  std::vector<double> hessian(max_stencil_width * max_stencil_width);
  Vector sum = Vector::Zero(x.size());
  for (std::size_t k = 0; k < model.elastic.size(); ++k) {
    const Energy& energy = *model.elastic[k];
    const double beta = model.stiffness_damping.empty() ? 0.0 : model.stiffness_damping[k].beta;
    const int width = energy.stencils().width();
    for (Index e = 0; e < energy.stencils().count(); ++e) {
      energy.stencils().gather(e, x, local.data());
      energy.stencils().gather(e, v, moving.data());
      energy.evaluate(e, local.data(), gradient.data(), hessian.data(), Curvature::positive_semidefinite);
      const Vector damping =
          beta * Eigen::Map<Matrix>(hessian.data(), width, width) * Eigen::Map<Vector>(moving.data(), width);
      for (int i = 0; i < width; ++i) sum[energy.stencils()[e][i]] -= gradient[i] + damping[i];
    }
  }
  return sum;
}

/// The motion by the classical Runge-Kutta method in steps of 1 ms: another discretisation, another code path.
Motion reference(const Model& model, double end) {
  Vector mass = Vector::Zero(model.positions.size());
  model.inertia[0]->add_product(Vector::Ones(model.positions.size()), mass);
  const auto acceleration = [&](const Vector& x, const Vector& v) {
    Vector a = forces(model, x, v).cwiseQuotient(mass) - model.mass_damping[0] * v;
    for (const PinnedVariable& held : model.pins) a[held.variable] = 0;
    return a;
  };
  Motion m{model.positions, model.velocities};
  const int steps = static_cast<int>(std::lround(end / 1e-3));
  const double h = end / steps;
  for (int k = 0; k < steps; ++k) {
    const Vector v1 = m.velocities, a1 = acceleration(m.positions, v1);
    const Vector v2 = m.velocities + 0.5 * h * a1, a2 = acceleration(m.positions + 0.5 * h * v1, v2);
    const Vector v3 = m.velocities + 0.5 * h * a2, a3 = acceleration(m.positions + 0.5 * h * v2, v3);
    const Vector v4 = m.velocities + h * a3, a4 = acceleration(m.positions + h * v3, v4);
    m.positions += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    m.velocities += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  return m;
}

struct Errors {
  double position, velocity;
};

Errors errors(const std::function<Model()>& make, const TimeOptions& scheme, double end, int steps,
              const Motion& exact) {
  Model model = make();
  TimeOptions options = scheme;
  options.steps = steps;
  options.step = end / steps;
  Stepper stepper(model, options);
  auto solver = tight_solver(1e-9);
  advance(stepper, solver, steps);
  return {(stepper.state().positions - exact.positions).norm(), (stepper.state().velocities - exact.velocities).norm()};
}

/// Expects errors to fall as step^order between 1/100 and 1/200 of the time.
void expect_order(double order, const std::function<Model()>& make, const TimeOptions& scheme, double end,
                  const Motion& exact) {
  const Errors coarse = errors(make, scheme, end, 100, exact), fine = errors(make, scheme, end, 200, exact);
  const double in_position = std::log2(coarse.position / fine.position),
               in_velocity = std::log2(coarse.velocity / fine.velocity);
  EXPECT_NEAR(in_position, order, 0.15) << "errors " << coarse.position << ", " << fine.position;
  EXPECT_NEAR(in_velocity, order, 0.15) << "errors " << coarse.velocity << ", " << fine.velocity;
}

struct Scheme {
  const char* name;
  TimeOptions options;
  double order;
};

TimeOptions with(Integrator integrator, double spectral_radius = 0.8) {
  TimeOptions options;
  options.integrator = integrator;
  options.spectral_radius = spectral_radius;
  return options;
}

TimeOptions with_newmark(double beta, double gamma) {
  TimeOptions options = with(Integrator::newmark);
  options.beta = beta;
  options.gamma = gamma;
  return options;
}

class OrderOfAccuracy : public testing::TestWithParam<Scheme> {};

INSTANTIATE_TEST_SUITE_P(All, OrderOfAccuracy,
                         testing::Values(Scheme{"implicit_euler", with(Integrator::implicit_euler), 1},
                                         Scheme{"bdf2", with(Integrator::bdf2), 2},
                                         Scheme{"generalised_alpha", with(Integrator::generalised_alpha), 2},
                                         Scheme{"generalised_alpha_0", with(Integrator::generalised_alpha, 0.0), 2},
                                         Scheme{"average_acceleration", with(Integrator::generalised_alpha, 1.0), 2},
                                         Scheme{"newmark_average_acceleration", with_newmark(0.25, 0.5), 2},
                                         Scheme{"newmark_default", with_newmark(0.3025, 0.6), 1}),
                         [](const auto& scheme) { return std::string(scheme.param.name); });

TEST_P(OrderOfAccuracy, IsReachedInAFreeNonlinearVibration) {
  const double end = 1.0;
  const auto make = [] { return vibrating_patch(); };
  expect_order(GetParam().order, make, GetParam().options, end, reference(make(), end));
}

TEST_P(OrderOfAccuracy, IsReachedWithMassDamping) {
  const double end = 1.0;
  const auto make = [] {
    Model model = vibrating_patch();
    model.mass_damping = {0.5};
    return model;
  };
  expect_order(GetParam().order, make, GetParam().options, end, reference(make(), end));
}

/// A rigid pendulum is all constraint: the angle obeys angle'' = -g sin(angle).
TEST_P(OrderOfAccuracy, IsReachedOnAConstraintThatIsActiveFromTheStart) {
  const double end = 0.5, gravity = 9.81;
  double angle = 1.0, rate = 0;
  const int steps = 5000;
  for (int k = 0; k < steps; ++k) {  // velocity Verlet; its error is 1e-8
    rate -= 0.5 * end / steps * gravity * std::sin(angle);
    angle += end / steps * rate;
    rate -= 0.5 * end / steps * gravity * std::sin(angle);
  }
  const auto make = [&] { return pendulum(1.0, gravity); };
  Motion exact{make().positions, make().velocities};
  exact.positions.tail<3>() = Vector3(0, std::sin(angle), -std::cos(angle));
  exact.velocities.tail<3>() = rate * Vector3(0, std::cos(angle), std::sin(angle));
  expect_order(GetParam().order, make, GetParam().options, end, exact);
}

/// Its stiffness is that of the start of the step, so the better integrators lose their second order, and the errors
/// are still those of a consistent method.
TEST(StiffnessDampingInTime, IsConsistentToFirstOrder) {
  const double end = 1.0;
  const auto make = [] {
    Model model = vibrating_patch();
    model.stiffness_damping.push_back({std::make_unique<StiffnessDamping>("damping", *model.elastic[0]), 0.1});
    return model;
  };
  const Motion exact = reference(make(), end);
  for (const Integrator integrator : {Integrator::implicit_euler, Integrator::bdf2, Integrator::generalised_alpha}) {
    const Errors coarse = errors(make, with(integrator), end, 100, exact),
                 fine = errors(make, with(integrator), end, 200, exact);
    EXPECT_GT(std::log2(coarse.position / fine.position), 0.85) << static_cast<int>(integrator);
    EXPECT_LT(fine.position, 0.02) << static_cast<int>(integrator);
  }
}

}  // namespace
}  // namespace taut
