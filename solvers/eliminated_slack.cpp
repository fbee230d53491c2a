#include "solvers/eliminated_slack.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace taut {
namespace {

using Rows = std::array<double, max_rows>;
using RowsByWidth = std::array<double, max_rows * max_stencil_width>;
using RowsByRows = std::array<double, max_rows * max_rows>;

}  // namespace

EliminatedSlack::EliminatedSlack(const Constraint& constraint)
    : constraint_(constraint), multipliers_(Vector::Zero(constraint.stencils().count() * constraint.rows())) {}

void EliminatedSlack::set_multipliers(const Vector& multipliers) {
  if (multipliers.size() != multipliers_.size()) {
    throw std::invalid_argument("EliminatedSlack::set_multipliers: expected " + std::to_string(multipliers_.size()) +
                                " entries for " + name() + ", got " + std::to_string(multipliers.size()));
  }
  multipliers_ = multipliers;
}

double EliminatedSlack::evaluate(Index element, const double* x, double* gradient, double* hessian,
                                 Curvature curvature) const {
  if (linearisation_ != Linearisation::augmented_lagrangian)
    return evaluate_primal_dual(element, x, gradient, hessian, curvature);
  const int rows = constraint_.rows(), width = stencils().width();
  const double* lambda = multipliers_.data() + element * rows;
  const double weight = constraint_.weight(element);
  Rows c, y, nearest, next;
  RowsByWidth jacobian;
  RowsByRows slope;
  constraint_.evaluate(element, x, c.data(), gradient ? jacobian.data() : nullptr);
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
    RowsByWidth stiff;
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

/// One element of the smoothed conditions F = lambda - lambda_s = 0, lambda_s = mu (y - P_s y), y = c + lambda/mu. With
/// D = P_s', Newton's equation D dlambda = mu (I - D) J dx - F eliminates dlambda = W J dx - D^{-1} F, W = mu D^{-1} (I
/// - D). D is kept from singularity by a shift that caps W at 1e8 mu.
struct EliminatedSlack::PrimalDual {
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_rows, max_rows>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_rows, 1>;
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, max_rows, max_stencil_width>;
  Column c, next, mismatch, correction;  // c, lambda_s, F, D^{-1} F
  Jacobian jacobian;
  Square stiffness;  // W

  PrimalDual(const EliminatedSlack& slack, Index element, const double* x, bool with_jacobian) {
    constexpr double shift = 1e-8;
    const Constraint& constraint = slack.constraint_;
    const int rows = constraint.rows();
    const Eigen::Map<const Vector> lambda(slack.multipliers_.data() + element * rows, rows);
    c.resize(rows);
    if (with_jacobian) jacobian.resize(rows, constraint.stencils().width());
    constraint.evaluate(element, x, c.data(), with_jacobian ? jacobian.data() : nullptr);
    const Column y = c + lambda / slack.penalty_;
    Column nearest(rows);
    Square slope(rows, rows);
    constraint.set().project_smoothed(element, y.data(), slack.epsilon_, nearest.data(), slope.data());
    next = slack.penalty_ * (y - nearest);
    mismatch = lambda - next;
    if (!with_jacobian) return;
    const Square identity = Square::Identity(rows, rows), inverse = invert(slope + shift * identity);
    stiffness = slack.penalty_ * inverse.lazyProduct(identity - slope);
    stiffness = Square(0.5 * (stiffness + stiffness.transpose()));
    correction = inverse.lazyProduct(mismatch);
  }

  static Square invert(const Square& matrix) {
    if (matrix.rows() == 1) return Square::Constant(1, 1, 1 / matrix(0, 0));
    if (matrix.rows() == 3) return Matrix3(matrix).inverse();
    return matrix.ldlt().solve(Square::Identity(matrix.rows(), matrix.rows()));
  }
};

double EliminatedSlack::evaluate_primal_dual(Index element, const double* x, double* gradient, double* hessian,
                                             Curvature curvature) const {
  if (!gradient) return 0;
  const int rows = constraint_.rows(), width = stencils().width();
  const double weight = constraint_.weight(element);
  const Eigen::Map<const Vector> lambda(multipliers_.data() + element * rows, rows);
  if (linearisation_ == Linearisation::held) {
    Rows c;
    PrimalDual::Jacobian jacobian(rows, width);
    constraint_.evaluate(element, x, c.data(), jacobian.data());
    Eigen::Map<Vector>(gradient, width) = weight * jacobian.transpose().lazyProduct(lambda);
    return 0;
  }
  const PrimalDual local(*this, element, x, true);
  Eigen::Map<Vector>(gradient, width) = weight * local.jacobian.transpose().lazyProduct(lambda - local.correction);
  if (hessian) {
    constraint_.hessian(element, x, local.next.data(), curvature, hessian);
    const PrimalDual::Jacobian stiff = local.stiffness.lazyProduct(local.jacobian);
    Eigen::Map<Matrix> h(hessian, width, width);
    h += local.jacobian.transpose().lazyProduct(stiff);
    h *= weight;
  }
  return 0;
}

EliminatedSlack::Mismatch EliminatedSlack::mismatch(const Vector& x) const {
  std::array<double, max_stencil_width> local;
  Mismatch out;
  double weights = 0;
  for (Index element = 0; element < stencils().count(); ++element) {
    stencils().gather(element, x, local.data());
    const double square =
        PrimalDual(*this, element, local.data(), false).mismatch.squaredNorm() / (penalty_ * penalty_);
    if (!(square <= out.max)) out.max = square;
    out.mean_square += constraint_.weight(element) * square;
    weights += constraint_.weight(element);
  }
  out.max = std::sqrt(out.max);
  if (weights > 0) out.mean_square /= weights;
  return out;
}

void EliminatedSlack::multiplier_step(const Vector& x, const Vector& dx, Vector& step) const {
  const int rows = constraint_.rows(), width = stencils().width();
  std::array<double, max_stencil_width> local, moved;
  step.resize(multipliers_.size());
  for (Index element = 0; element < stencils().count(); ++element) {
    stencils().gather(element, x, local.data());
    stencils().gather(element, dx, moved.data());
    const PrimalDual here(*this, element, local.data(), true);
    const PrimalDual::Column change = here.jacobian.lazyProduct(Eigen::Map<const Vector>(moved.data(), width));
    step.segment(element * rows, rows) = here.stiffness.lazyProduct(change) - here.correction;
  }
}

void EliminatedSlack::updated_multipliers(const Vector& x, double cap, Vector& updated) const {
  const int rows = constraint_.rows();
  updated.resize(multipliers_.size());
  std::array<double, max_stencil_width> local;
  Rows c, y, nearest;
  for (Index element = 0; element < stencils().count(); ++element) {
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
  std::array<double, max_stencil_width> local;
  Rows c, y, nearest;
  RowsByWidth jacobian;
  for (Index element = 0; element < stencils().count(); ++element) {
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
