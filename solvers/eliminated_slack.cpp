#include "solvers/eliminated_slack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/scratch.h"
#include "solvers/eliminated_slack_path.h"

namespace taut {
namespace {

using Rows = std::array<double, max_rows>;
using RowsByWidth = Scratch<max_rows * max_stencil_width>;
using RowsByRows = std::array<double, max_rows * max_rows>;

}  // namespace

EliminatedSlack::EliminatedSlack(const Constraint& constraint)
    : constraint_(constraint),
      multipliers_(Vector::Zero(constraint.stencils().count() * constraint.rows())),
      weights_(constraint.stencils().count()),
      left_out_(static_cast<std::size_t>(constraint.stencils().count()), 0) {
  for (Index element = 0; element < weights_.size(); ++element) weights_[element] = constraint.weight(element);
}

void EliminatedSlack::set_multipliers(const Vector& multipliers) {
  if (multipliers.size() != multipliers_.size()) {
    throw std::invalid_argument("EliminatedSlack::set_multipliers: expected " + std::to_string(multipliers_.size()) +
                                " entries for " + name() + ", got " + std::to_string(multipliers.size()));
  }
  multipliers_ = multipliers;
}

double EliminatedSlack::evaluate(Index element, const double* x, double* gradient, double* hessian,
                                 Curvature curvature) const {
  if (left_out(element)) {
    if (gradient) std::fill_n(gradient, stencils().width(), 0.0);
    if (hessian) std::fill_n(hessian, stencils().width() * stencils().width(), 0.0);
    return 0;
  }
  if (linearisation_ != Linearisation::augmented_lagrangian)
    return evaluate_path(element, x, gradient, hessian, curvature);
  const int rows = constraint_.rows(), width = stencils().width();
  const double* lambda = multipliers_.data() + element * rows;
  const double weight = constraint_.weight(element);
  Rows c, y, nearest, next;
  RowsByWidth jacobian_memory(rows * width);
  double* jacobian = jacobian_memory.data();
  RowsByRows slope;
  constraint_.evaluate(element, x, c.data(), gradient ? jacobian : nullptr);
  for (int i = 0; i < rows; ++i) y[i] = c[i] + lambda[i] / penalty_;
  constraint_.set().project(element, y.data(), nearest.data(), hessian ? slope.data() : nullptr);
  double value = 0;
  bool active = false;
  for (int i = 0; i < rows; ++i) {
    next[i] = penalty_ * (y[i] - nearest[i]);
    active = active || next[i] != 0;
    value += next[i] * next[i] - lambda[i] * lambda[i];
  }
  if (gradient) {
    for (int k = 0; k < width; ++k) {
      double sum = 0;
      for (int i = 0; i < rows; ++i) sum += jacobian[k * rows + i] * next[i];
      gradient[k] = weight * sum;
    }
  }
  if (hessian) {
    if (!active) {
      std::fill_n(hessian, width * width, 0.0);
      return value * weight / (2 * penalty_);
    }
    constraint_.hessian(element, x, next.data(), curvature, hessian);
    // Row by row of mu (I - P') J, then J^T times it.
    RowsByWidth stiff_memory(rows * width);
    double* stiff = stiff_memory.data();
    for (int k = 0; k < width; ++k) {
      for (int i = 0; i < rows; ++i) {
        double sum = jacobian[k * rows + i];
        for (int j = 0; j < rows; ++j) sum -= slope[i * rows + j] * jacobian[k * rows + j];
        stiff[i * width + k] = penalty_ * sum;
      }
    }
    for (int k = 0; k < width; ++k) {
      double* column = hessian + k * width;
      for (int i = 0; i < rows; ++i) {
        const double factor = jacobian[k * rows + i];
        for (int l = 0; l < width; ++l) column[l] += factor * stiff[i * width + l];
      }
      for (int l = 0; l < width; ++l) column[l] *= weight;
    }
  }
  return value * weight / (2 * penalty_);
}

EliminatedSlack::~EliminatedSlack() = default;

void EliminatedSlack::updated_multipliers(const Vector& x, double cap, Vector& updated) const {
  const int rows = constraint_.rows();
  updated.setZero(multipliers_.size());
  Scratch<max_stencil_width> local(stencils().width());
  Rows c, y, nearest;
  for (Index element = 0; element < stencils().count(); ++element) {
    if (left_out(element)) continue;
    stencils().gather(element, x, local.data());
    constraint_.evaluate(element, local.data(), c.data(), nullptr);
    for (int i = 0; i < rows; ++i) y[i] = c[i] + multipliers_[element * rows + i] / penalty_;
    constraint_.set().project(element, y.data(), nearest.data(), nullptr);
    auto next = updated.segment(element * rows, rows);
    for (int i = 0; i < rows; ++i) next[i] = penalty_ * (y[i] - nearest[i]);
    const double norm = next.norm();
    if (norm > cap) next *= cap / norm;
  }
}

void EliminatedSlack::add_update_force(const Vector& x, Vector& force) const {
  const int rows = constraint_.rows(), width = stencils().width();
  Scratch<max_stencil_width> local(width);
  Rows c, y, nearest;
  RowsByWidth jacobian(rows * width);
  for (Index element = 0; element < stencils().count(); ++element) {
    if (left_out(element)) continue;
    stencils().gather(element, x, local.data());
    const double* lambda = multipliers_.data() + element * rows;
    constraint_.evaluate(element, local.data(), c.data(), jacobian.data());
    for (int i = 0; i < rows; ++i) y[i] = c[i] + lambda[i] / penalty_;
    constraint_.set().project(element, y.data(), nearest.data(), nullptr);
    const double weight = constraint_.weight(element);
    for (int k = 0; k < width; ++k) {
      double sum = 0;
      for (int i = 0; i < rows; ++i) sum += jacobian[k * rows + i] * (penalty_ * (y[i] - nearest[i]) - lambda[i]);
      force[stencils()[element][k]] += weight * sum;
    }
  }
}

}  // namespace taut
