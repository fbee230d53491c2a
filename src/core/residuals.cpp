#include "core/residuals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/scratch.h"

namespace taut {
namespace {

/// Raises `largest` to `value` and says whether it did; a NaN counts as largest of all and stays.
bool raise(double& largest, double value) {
  if (value <= largest || std::isnan(largest)) return false;
  largest = value;
  return true;
}

/// The largest Euclidean norm over nodes of `node_size` consecutive entries, and which node has it.
struct NodalMax {
  double norm = 0;
  Index node = -1;
};

NodalMax nodal_max(const Vector& force, int node_size) {
  NodalMax worst;
  for (Index node = 0; node < force.size() / node_size; ++node) {
    if (raise(worst.norm, force.segment(node * node_size, node_size).norm())) worst.node = node;
  }
  return worst;
}

void check_multipliers(const Problem& problem, const std::vector<Vector>& multipliers) {
  const std::size_t vectors = problem.constraints.size() + problem.equalities.size();
  if (multipliers.size() != vectors) {
    throw std::invalid_argument("residuals: " + std::to_string(multipliers.size()) + " multiplier vectors, expected " +
                                std::to_string(vectors));
  }
  const auto check_size = [](const std::string& name, const Vector& one, Index expected) {
    if (one.size() == expected) return;
    throw std::invalid_argument("residuals: multipliers of " + name + " have " + std::to_string(one.size()) +
                                " entries, expected " + std::to_string(expected));
  };
  for (std::size_t k = 0; k < problem.constraints.size(); ++k) {
    const Constraint& constraint = *problem.constraints[k];
    check_size(constraint.name(), multipliers[k], constraint.stencils().count() * constraint.rows());
  }
  for (std::size_t k = 0; k < problem.equalities.size(); ++k) {
    const LinearEqualities& equal = *problem.equalities[k];
    check_size(equal.name, multipliers[problem.constraints.size() + k], equal.rows.rows());
  }
}

/// Adds grad W of every element of `energy` to `force`; false where a value is not finite (x is outside the energy's
/// domain).
bool add_gradient(const Energy& energy, const Vector& x, Vector& force) {
  const Stencils& stencils = energy.stencils();
  Scratch<max_stencil_width> local(stencils.width()), gradient(stencils.width());
  bool finite = true;
  for (Index element = 0; element < stencils.count(); ++element) {
    stencils.gather(element, x, local.data());
    finite =
        std::isfinite(energy.evaluate(element, local.data(), gradient.data(), nullptr, Curvature::exact)) && finite;
    for (int i = 0; i < stencils.width(); ++i) force[stencils[element][i]] += gradient[i];
  }
  return finite;
}

/// Adds w J^T lambda of every element to `force`, and records violation and complementarity of the constraint.
void judge(const Constraint& constraint, const Vector& x, const Vector& multipliers, Vector& force,
           Residuals& residuals) {
  const Stencils& stencils = constraint.stencils();
  const int rows = constraint.rows(), width = stencils.width();
  Scratch<max_stencil_width> local(width);
  std::array<double, max_rows> c, moved, nearest, nearest_moved;
  Scratch<max_rows * max_stencil_width> jacobian(rows * width);

  double scale = 0;
  for (Index element = 0; element < stencils.count(); ++element) {
    scale = std::max(scale, multipliers.segment(element * rows, rows).norm());
  }
  Violation violation;
  violation.constraint = constraint.name();
  for (Index element = 0; element < stencils.count(); ++element) {
    stencils.gather(element, x, local.data());
    const double* lambda = multipliers.data() + element * rows;
    constraint.evaluate(element, local.data(), c.data(), jacobian.data());
    for (int i = 0; i < width; ++i) {
      double sum = 0;
      for (int row = 0; row < rows; ++row) sum += jacobian[i * rows + row] * lambda[row];
      force[stencils[element][i]] += constraint.weight(element) * sum;
    }
    if (raise(violation.max, constraint.violation(element, local.data()))) violation.element = element;
    if (!std::all_of(lambda, lambda + rows, [](double entry) { return entry == 0; })) {
      // From the nearest point of K, not from c: outside K a multiplier of the wrong sign could otherwise go unseen.
      constraint.set().project(element, c.data(), nearest.data(), nullptr);
      for (int row = 0; row < rows; ++row) moved[row] = nearest[row] + lambda[row] / scale;
      constraint.set().project(element, moved.data(), nearest_moved.data(), nullptr);
      double square = 0;
      for (int row = 0; row < rows; ++row)
        square += (nearest_moved[row] - nearest[row]) * (nearest_moved[row] - nearest[row]);
      const double distance = std::sqrt(square);
      raise(residuals.complementarity, distance);
      raise(residuals.complementarity_unscaled, distance * scale);
    }
  }
  if (violation.element >= 0) violation.where = constraint.element_name(violation.element);
  raise(residuals.feasibility, violation.max / constraint.violation_scale());
  raise(residuals.feasibility_unscaled, violation.max);
  residuals.violations.push_back(violation);
}

/// Adds A^T nu to `force` and records the violation; any multiplier of an equality is complementary.
void judge(const LinearEqualities& equal, const Vector& x, const Vector& multipliers, Vector& force,
           Residuals& residuals) {
  force += equal.rows.transpose() * multipliers;
  const Vector off = equal.rows * x - equal.values;
  Violation violation{equal.name, 0, "", -1};
  for (Index row = 0; row < off.size(); ++row) {
    if (raise(violation.max, std::abs(off[row]))) violation.element = row;
  }
  if (violation.element >= 0 && equal.row_name) violation.where = equal.row_name(violation.element);
  raise(residuals.feasibility, violation.max / equal.violation_scale);
  raise(residuals.feasibility_unscaled, violation.max);
  residuals.violations.push_back(violation);
}

}  // namespace

void Tolerances::validate() const {
  if (!(stationarity > 0) || !(feasibility > 0) || !(complementarity > 0)) {
    throw std::invalid_argument("Tolerances: stationarity, feasibility and complementarity must be positive");
  }
}

bool Residuals::within(const Tolerances& tolerances) const {
  return finite && stationarity <= tolerances.stationarity && feasibility <= tolerances.feasibility &&
         complementarity <= tolerances.complementarity;
}

double Residuals::over(const Tolerances& t) const {
  if (!finite) return std::numeric_limits<double>::infinity();
  return std::max({stationarity / t.stationarity, feasibility / t.feasibility, complementarity / t.complementarity});
}

Judge::Judge(const Problem& problem, const Vector& x)
    : problem_(problem), x_(x), energies_force_(Vector::Zero(problem.size())), force_scale_(problem.least_force_scale) {
  if (x.size() != problem.size()) {
    throw std::invalid_argument("residuals: result.x has " + std::to_string(x.size()) + " entries, expected " +
                                std::to_string(problem.size()));
  }
  Vector term(problem.size());
  for (const Energy* energy : problem.energies) {
    term.setZero();
    finite_ = add_gradient(*energy, x, term) && finite_;
    raise(force_scale_, nodal_max(term, problem.node_size).norm);
    energies_force_ += term;
  }
}

Residuals Judge::operator()(const std::vector<Vector>& multipliers) const {
  check_multipliers(problem_, multipliers);
  Residuals residuals;
  residuals.finite = finite_;
  residuals.force_scale = force_scale_;
  Vector total = energies_force_, term(problem_.size());
  const auto add_term = [&] {
    raise(residuals.force_scale, nodal_max(term, problem_.node_size).norm);
    total += term;
  };
  for (std::size_t k = 0; k < problem_.constraints.size(); ++k) {
    term.setZero();
    judge(*problem_.constraints[k], x_, multipliers[k], term, residuals);
    add_term();
  }
  for (std::size_t k = 0; k < problem_.equalities.size(); ++k) {
    term.setZero();
    judge(*problem_.equalities[k], x_, multipliers[problem_.constraints.size() + k], term, residuals);
    add_term();
  }
  if (!problem_.fixed_variables.empty()) {
    Violation pins{"pins", 0, "", -1};
    term.setZero();
    for (std::size_t i = 0; i < problem_.fixed_variables.size(); ++i) {
      const int variable = problem_.fixed_variables[i];
      term[variable] = -total[variable];
      const double off = std::abs(x_[variable] - problem_.fixed_values[static_cast<Index>(i)]);
      if (raise(pins.max, off)) pins.element = variable / problem_.node_size;
    }
    if (pins.element >= 0) pins.where = "vertex " + std::to_string(pins.element);
    // Pins are met to the last bit by substitution; any distance at all is measured against the size of the values.
    const double size = std::max(problem_.fixed_values.lpNorm<Eigen::Infinity>(), 1e-300);
    raise(residuals.feasibility, pins.max / size);
    raise(residuals.feasibility_unscaled, pins.max);
    residuals.violations.push_back(pins);
    add_term();
  }
  const NodalMax worst = nodal_max(total, problem_.node_size);
  residuals.stationarity_unscaled = worst.norm;
  residuals.worst_node = worst.node < 0 ? "" : "vertex " + std::to_string(worst.node);
  residuals.stationarity = worst.norm == 0 ? 0.0 : worst.norm / residuals.force_scale;
  residuals.finite = residuals.finite && total.allFinite() && x_.allFinite() && std::isfinite(residuals.feasibility) &&
                     std::isfinite(residuals.complementarity) && std::isfinite(residuals.force_scale);
  return residuals;
}

Residuals residuals(const Problem& problem, const Result& result) {
  return Judge(problem, result.x)(result.multipliers);
}

}  // namespace taut
