#include "dynamics/stepper.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "dynamics/modal/modal_energies.h"

namespace taut {
namespace {

/// Coefficients of the generalised-alpha method for a spectral radius at infinite frequency [Chung and Hulbert 1993,
/// (25) and (17), (20)].
struct AlphaCoefficients {
  double am, af, gamma, beta;

  explicit AlphaCoefficients(double spectral_radius)
      : am((2 * spectral_radius - 1) / (spectral_radius + 1)),
        af(spectral_radius / (spectral_radius + 1)),
        gamma(0.5 - am + af),
        beta(0.25 * (1 - am + af) * (1 - am + af)) {}
};

double value_at(const Energy& energy, const Vector& positions) {
  std::array<double, max_stencil_width> local;
  double sum = 0;
  for (Index element = 0; element < energy.stencils().count(); ++element) {
    energy.stencils().gather(element, positions, local.data());
    sum += energy.evaluate(element, local.data(), nullptr, nullptr, Curvature::exact);
  }
  return sum;
}

template <class Owned>
void append(std::vector<const Energy*>& energies, const std::vector<std::unique_ptr<Owned>>& more) {
  for (const auto& energy : more) energies.push_back(energy.get());
}

std::vector<const Energy*> energies_of(const Model& model, bool dynamic) {
  std::vector<const Energy*> energies;
  if (dynamic) append(energies, model.inertia);
  append(energies, model.elastic);
  if (dynamic) {
    for (const auto& damping : model.stiffness_damping) energies.push_back(damping.energy.get());
  }
  append(energies, model.dead_loads);
  append(energies, model.warped_loads);
  append(energies, model.pressures);
  append(energies, model.end_moments);
  for (const auto& load : model.lagged_loads) energies.push_back(load.energy.get());
  return energies;
}

void check_size(const Vector& vector, Index expected, const char* what) {
  if (vector.size() != expected) {
    throw std::invalid_argument(std::string("Stepper: ") + what + " has " + std::to_string(vector.size()) +
                                " entries, expected " + std::to_string(expected));
  }
}

}  // namespace

void TimeOptions::validate() const {
  if (!(step > 0) || !std::isfinite(step))
    throw std::invalid_argument("TimeOptions: step must be positive and finite, got " + std::to_string(step));
  if (steps < 1) throw std::invalid_argument("TimeOptions: steps must be at least 1, got " + std::to_string(steps));
  if (!(spectral_radius >= 0 && spectral_radius <= 1)) {
    throw std::invalid_argument("TimeOptions: spectral_radius must be in [0, 1], got " +
                                std::to_string(spectral_radius));
  }
  if (!(beta > 0) || !std::isfinite(beta) || !std::isfinite(gamma) || !(gamma > 0))
    throw std::invalid_argument("TimeOptions: beta and gamma must be positive and finite, got " + std::to_string(beta) +
                                " and " + std::to_string(gamma));
}

Stepper::Stepper(Model& model, TimeOptions options) : model_(model), options_(options) {
  options_.validate();
  const Index size = model_.positions.size();
  check_size(model_.velocities, size, "model.velocities");
  if (model_.mass_damping.size() != model_.inertia.size()) {
    throw std::invalid_argument("Stepper: model.mass_damping has " + std::to_string(model_.mass_damping.size()) +
                                " entries, expected " + std::to_string(model_.inertia.size()));
  }

  problem_.name = model_.name;
  problem_.topology = new_topology();
  problem_.energies = energies_of(model_, dynamic());
  for (const auto& constraint : model_.constraints) problem_.constraints.push_back(constraint.get());
  for (const auto& equal : model_.equalities) problem_.equalities.push_back(equal.get());
  for (const PinnedVariable& pin : model_.pins) problem_.fixed_variables.push_back(pin.variable);
  problem_.fixed_values.resize(static_cast<Index>(model_.pins.size()));
  problem_.initial_guess = model_.positions;
  if (model_.modal) problem_.node_size = 1;

  state_.positions = model_.positions;
  state_.velocities = dynamic() ? model_.velocities : Vector(Vector::Zero(size));
  if (dynamic()) {
    for (const PinnedVariable& pin : model_.pins) {
      state_.velocities[pin.variable] = (pin.value(options_.step) - pin.value(-options_.step)) / (2 * options_.step);
    }
  }
  state_.previous_positions = state_.positions;
  state_.previous_velocities = state_.velocities;
  state_.accelerations = state_.auxiliary_accelerations = Vector::Zero(size);
  place(0);
}

void Stepper::restore(State state) {
  const Index size = model_.positions.size();
  check_size(state.positions, size, "state.positions");
  check_size(state.velocities, size, "state.velocities");
  check_size(state.accelerations, size, "state.accelerations");
  check_size(state.previous_positions, size, "state.previous_positions");
  check_size(state.previous_velocities, size, "state.previous_velocities");
  check_size(state.auxiliary_accelerations, size, "state.auxiliary_accelerations");
  if (state.step < 0)
    throw std::invalid_argument("Stepper: state.step is " + std::to_string(state.step) + ", expected 0 or more");
  state_ = std::move(state);
  place(time());
}

double Stepper::time_at(int step) const {
  return dynamic() ? step * options_.step : static_cast<double>(step) / options_.steps;
}

/// Moves obstacles to where they are at `time` and, in a static problem, loads to that fraction.
void Stepper::place(double time) {
  for (const auto& mover : model_.movers) mover(time);
  const double factor = dynamic() ? 1.0 : time;
  for (const auto& load : model_.dead_loads) load->set_factor(factor);
  for (const auto& load : model_.warped_loads) load->set_factor(factor);
  for (const auto& pressure : model_.pressures) pressure->set_factor(factor);
  for (const auto& moment : model_.end_moments) moment->set_factor(factor);
  for (const auto& load : model_.lagged_loads) load.energy->set_factor(factor);
}

Stepper::EndOfStep Stepper::end_of_step() const {
  const double h = options_.step;
  const Vector &x = state_.positions, &v = state_.velocities;
  EndOfStep end;
  if (options_.integrator == Integrator::implicit_euler) {
    end = {1 / (h * h), 1 / h, x + h * v, x};
  } else if (state_.step == 0) {
    end = {2 / (h * h), 2 / h, x + h * v, x + (0.5 * h) * v};
  } else if (options_.integrator == Integrator::bdf2) {
    const Vector origin = (4 * x - state_.previous_positions) / 3;
    end = {9 / (4 * h * h), 3 / (2 * h), origin + (h / 9) * (8 * v - 2 * state_.previous_velocities), origin};
  } else if (options_.integrator == Integrator::newmark) {
    const double reach = options_.beta * h * h;
    const Vector predicted = x + h * v + (h * h * (0.5 - options_.beta)) * state_.accelerations;  // MW (A.8)
    const Vector rate = v + (h * (1 - options_.gamma)) * state_.accelerations;                    // MW (A.9)
    end = {1 / reach, options_.gamma / (options_.beta * h), predicted,
           predicted - (options_.beta * h / options_.gamma) * rate};
  } else {
    // With A the auxiliary acceleration, (1 - am) A' + am A = (1 - af) a' + af a, and Newmark's formulas in A:
    // x' = x + h v + h^2 ((1/2 - beta) A + beta A'), v' = v + h ((1 - gamma) A + gamma A').
    const AlphaCoefficients c(options_.spectral_radius);
    const Vector &a = state_.accelerations, &auxiliary = state_.auxiliary_accelerations;
    const double reach = c.beta * h * h;
    const Vector predicted = x + h * v + (h * h * (0.5 - c.beta)) * auxiliary;
    end = {(1 - c.am) / ((1 - c.af) * reach), c.gamma / (c.beta * h),
           predicted - (reach / (1 - c.am)) * (c.am * auxiliary - c.af * a),
           predicted - (c.beta * h / c.gamma) * (v + (h * (1 - c.gamma)) * auxiliary)};
  }
  follow_scripts(end);
  return end;
}

/// Pinned variables take velocity and acceleration from central differences of their scripts, not from the integrator,
/// whose recursions would ring for ever after a jump in a script's velocity. At rest both are exactly zero.
void Stepper::follow_scripts(EndOfStep& end) const {
  const double h = options_.step, time = time_at(state_.step + 1);
  for (const PinnedVariable& pin : model_.pins) {
    const double before = pin.value(time - h), at = pin.value(time), after = pin.value(time + h);
    end.origin[pin.variable] = at - (after - before) / (2 * h * end.rate);
    end.target[pin.variable] = at - ((after - at) - (at - before)) / (h * h * end.stiffness);
  }
}

const Problem& Stepper::prepare(double part) {
  const double end_time = dynamic() || part == 1 ? time_at(state_.step + 1) : (state_.step + part) / options_.steps;
  place(end_time);
  if (dynamic()) {
    const EndOfStep end = end_of_step();
    for (std::size_t k = 0; k < model_.inertia.size(); ++k) {
      // Inertia and mass damping are both quadratic: stiffness (x - target) + alpha rate (x - origin) is one square,
      // completed.
      const double damping = model_.mass_damping[k] * end.rate, sum = end.stiffness + damping;
      if (damping == 0) {
        model_.inertia[k]->set_target(sum, end.target);
      } else {
        model_.inertia[k]->set_target(sum, (end.stiffness * end.target + damping * end.origin) / sum);
      }
    }
    for (const auto& damping : model_.stiffness_damping) {
      damping.energy->set_reference(damping.beta * end.rate, state_.positions, end.origin);
    }
  }
  for (const auto& freeze : model_.freezers) {
    const double h = options_.step;
    freeze(state_.positions + h * state_.velocities + (0.5 * h * h) * state_.accelerations);
  }
  for (const auto& load : model_.lagged_loads) {
    Vector forces = Vector::Zero(state_.positions.size());
    load.forces(state_.positions, state_.velocities, forces);
    load.energy->set_forces(forces);
  }
  for (const auto& moment : model_.end_moments) moment->set_reference(state_.positions);
  problem_.initial_guess = state_.positions;
  if (dynamic()) problem_.initial_guess += options_.step * state_.velocities;
  for (std::size_t k = 0; k < model_.pins.size(); ++k) {
    const double value = model_.pins[k].value(end_time);
    problem_.fixed_values[static_cast<Index>(k)] = value;
    problem_.initial_guess[model_.pins[k].variable] = value;
  }
  return problem_;
}

void Stepper::hold(const Result& result) {
  check_size(result.x, state_.positions.size(), "result.x");
  state_.positions = result.x;
  state_.warm.multipliers = result.multipliers;
  state_.warm.penalties = result.penalties;
  state_.warm.force_scale = result.force_scale;
  state_.warm.changes = result.changes;
}

void Stepper::accept(const Result& result) {
  check_size(result.x, state_.positions.size(), "result.x");
  State next;
  next.step = state_.step + 1;
  next.positions = result.x;
  next.velocities = next.accelerations = next.auxiliary_accelerations = Vector::Zero(result.x.size());
  if (dynamic()) {
    const EndOfStep end = end_of_step();
    next.velocities = end.rate * (result.x - end.origin);
    next.accelerations = end.stiffness * (result.x - end.target);
    next.auxiliary_accelerations = next.accelerations;
    if (options_.integrator == Integrator::generalised_alpha && state_.step > 0) {
      const AlphaCoefficients c(options_.spectral_radius);
      next.auxiliary_accelerations =
          ((1 - c.af) * next.accelerations + c.af * state_.accelerations - c.am * state_.auxiliary_accelerations) /
          (1 - c.am);
    }
  }
  next.warm.multipliers = result.multipliers;
  next.warm.penalties = result.penalties;
  next.warm.force_scale = result.force_scale;
  next.warm.changes = result.changes;
  next.previous_positions = std::move(state_.positions);
  next.previous_velocities = std::move(state_.velocities);
  state_ = std::move(next);
}

std::vector<std::pair<std::string, double>> Stepper::energies() const {
  std::vector<std::pair<std::string, double>> list;
  double kinetic = 0;
  for (const auto& inertia : model_.inertia) kinetic += inertia->kinetic_energy(state_.velocities);
  list.emplace_back("kinetic", kinetic);
  const auto add = [&](const Energy& energy) { list.emplace_back(energy.name(), value_at(energy, state_.positions)); };
  for (const auto& energy : model_.elastic) add(*energy);
  for (const auto& load : model_.dead_loads) add(*load);
  for (const auto& load : model_.warped_loads) add(*load);
  for (const auto& pressure : model_.pressures) add(*pressure);
  return list;
}

}  // namespace taut
