#include "solvers/eliminated_slack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/parallel.h"
#include "core/scratch.h"

namespace taut {
namespace {

using Rows = std::array<double, max_rows>;
using RowsByWidth = Scratch<max_rows * max_stencil_width>;
using RowsByRows = std::array<double, max_rows * max_rows>;

}  // namespace

EliminatedSlack::EliminatedSlack(const Constraint& constraint)
    : constraint_(constraint),
      multipliers_(Vector::Zero(constraint.stencils().count() * constraint.rows())),
      left_out_(static_cast<std::size_t>(constraint.stencils().count()), 0) {}

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

/// The smoothed conditions F = lambda - lambda_s = 0, lambda_s = mu (y - P_s(y, epsilon)), y = c + lambda/mu, of all
/// elements. With D = dP_s/dy, Newton's equation towards epsilon + depsilon, D dlambda = mu (I - D) J dx - F - mu
/// dP_s/depsilon depsilon, eliminates dlambda = W J dx - r, W = mu (D^{-1} - I).
struct EliminatedSlack::Path {
  int rows, width;
  double epsilon = 0;
  // One column per element.
  Matrix smoothed;    // lambda_s
  Matrix mismatch;    // F
  Matrix rate;        // dP_s/depsilon
  Matrix jacobian;    // J, rows x width
  Matrix inverse;     // D^{-1}, rows x rows
  Matrix correction;  // r
  Vector square;      // |F|^2/mu^2

  Path(int r, int w, Index count)
      : rows(r),
        width(w),
        smoothed(r, count),
        mismatch(r, count),
        rate(r, count),
        jacobian(r * w, count),
        inverse(r * r, count),
        correction(r, count),
        square(count) {}

  /// A local matrix of fixed size where R and W are positive; where they are Eigen::Dynamic, of up to max_rows rows and
  /// any width.
  template <int R, int W>
  using Local = Eigen::Matrix<double, R, W, 0, (R < 0 ? max_rows : R), W>;
  /// r = D^{-1} (F + mu dP_s/depsilon depsilon), with `change` = mu depsilon.
  template <int R>
  void aim(Index element, double change) {
    const Eigen::Map<const Local<R, R>> d_inverse(inverse.col(element).data(), rows, rows);
    Local<R, 1> f = mismatch.col(element);
    f += change * rate.col(element);
    Eigen::Map<Local<R, 1>>(correction.col(element).data(), rows) = d_inverse.lazyProduct(f);
  }
  /// W J dx - r.
  template <int R, int W>
  void multiplier_step(Index element, double penalty, const double* dx, double* out) const {
    const Eigen::Map<const Local<R, W>> j(jacobian.col(element).data(), rows, width);
    const Eigen::Map<const Local<R, R>> d_inverse(inverse.col(element).data(), rows, rows);
    const Local<R, 1> change = j.lazyProduct(Eigen::Map<const Local<W, 1>>(dx, width));
    Eigen::Map<Local<R, 1>>(out, rows) = penalty * (d_inverse.lazyProduct(change) - change) - correction.col(element);
  }
  template <int R, int W>
  void gradient(Index element, double weight, const double* lambda, double* out) const {
    const Eigen::Map<const Local<R, W>> j(jacobian.col(element).data(), rows, width);
    const Eigen::Map<const Local<R, 1>> force(lambda, rows);
    Eigen::Map<Local<W, 1>>(out, width) = weight * j.transpose().lazyProduct(force);
  }
  /// Adds J^T W J and multiplies by the weight.
  template <int R, int W>
  void hessian(Index element, double weight, double penalty, double* out) const {
    const Eigen::Map<const Local<R, W>> j(jacobian.col(element).data(), rows, width);
    const Eigen::Map<const Local<R, R>> d_inverse(inverse.col(element).data(), rows, rows);
    const Local<R, R> w = penalty * (d_inverse - Local<R, R>::Identity(rows, rows));
    Eigen::Map<Eigen::Matrix<double, W, W>> h(out, width, width);
    for (int k = 0; k < width; ++k) {
      const Local<R, 1> stiff = w.lazyProduct(j.col(k));
      h.col(k) = weight * (h.col(k) + j.transpose().lazyProduct(stiff));
    }
  }

  /// What strain limits in matrix form have, and most scenes have nothing else.
  bool is_triangle() const { return rows == 3 && width == 9; }

  /// task(first, last) for ranges of elements, each once.
  template <class Task>
  void for_ranges(int threads, const Task& task) const {
    parallel_for(threads, [&](int t) { task(square.size() * t / threads, square.size() * (t + 1) / threads); });
  }
};

EliminatedSlack::Mismatch EliminatedSlack::set_point(const Vector& x, double epsilon, int threads) {
  const int rows = constraint_.rows();
  if (!path_) path_ = std::make_unique<Path>(rows, stencils().width(), stencils().count());
  Path& path = *path_;
  path.epsilon = epsilon;
  path.for_ranges(threads, [&](Index first, Index last) {
    Scratch<max_stencil_width> local(stencils().width());
    Rows c, y, nearest;
    for (Index element = first; element < last; ++element) {
      if (left_out(element)) continue;
      stencils().gather(element, x, local.data());
      constraint_.evaluate(element, local.data(), c.data(), path.jacobian.col(element).data());
      const double* lambda = multipliers_.data() + element * rows;
      for (int i = 0; i < rows; ++i) y[i] = c[i] + lambda[i] / penalty_;
      constraint_.set().project_smoothed(element, y.data(), epsilon, nearest.data(), path.inverse.col(element).data(),
                                         path.rate.col(element).data());
      double square = 0;
      for (int i = 0; i < rows; ++i) {
        path.smoothed(i, element) = penalty_ * (y[i] - nearest[i]);
        path.mismatch(i, element) = lambda[i] - path.smoothed(i, element);
        square += path.mismatch(i, element) * path.mismatch(i, element);
      }
      path.square[element] = square / (penalty_ * penalty_);
    }
  });
  Mismatch out;
  double weights = 0;
  for (Index element = 0; element < path.square.size(); ++element) {
    if (left_out(element)) continue;
    if (!(path.square[element] <= out.max)) out.max = path.square[element];
    out.mean_square += constraint_.weight(element) * path.square[element];
    weights += constraint_.weight(element);
  }
  out.max = std::sqrt(out.max);
  if (weights > 0) out.mean_square /= weights;
  return out;
}

void EliminatedSlack::aim(double target_epsilon, int threads, Vector& gradient) {
  Path& path = *path_;
  const double change = penalty_ * (target_epsilon - path.epsilon);
  path.for_ranges(threads, [&](Index first, Index last) {
    for (Index element = first; element < last; ++element) {
      if (left_out(element)) continue;
      path.is_triangle() ? path.aim<3>(element, change) : path.aim<-1>(element, change);
    }
  });
  Scratch<max_stencil_width> force(path.width);
  for (Index element = 0; element < path.square.size(); ++element) {
    if (left_out(element)) continue;
    path_gradient(element, path.correction.col(element).data(), force.data());
    const int* variables = stencils()[element];
    for (int k = 0; k < path.width; ++k) gradient[variables[k]] -= force[k];
  }
}

/// w J^T lambda of one element.
void EliminatedSlack::path_gradient(Index element, const double* lambda, double* gradient) const {
  const Path& path = *path_;
  const double weight = constraint_.weight(element);
  path.is_triangle() ? path.gradient<3, 9>(element, weight, lambda, gradient)
                     : path.gradient<-1, -1>(element, weight, lambda, gradient);
}

double EliminatedSlack::evaluate_path(Index element, const double* x, double* gradient, double* hessian,
                                      Curvature curvature) const {
  if (!gradient) return 0;
  const Path& path = *path_;
  path_gradient(element, multipliers_.data() + element * path.rows, gradient);
  if (!hessian) return 0;
  constraint_.hessian(element, x, path.smoothed.col(element).data(), curvature, hessian);
  const double weight = constraint_.weight(element);
  path.is_triangle() ? path.hessian<3, 9>(element, weight, penalty_, hessian)
                     : path.hessian<-1, -1>(element, weight, penalty_, hessian);
  return 0;
}

void EliminatedSlack::multiplier_step(const Vector& dx, int threads, Vector& step) const {
  const Path& path = *path_;
  step.resize(multipliers_.size());
  path.for_ranges(threads, [&](Index first, Index last) {
    Scratch<max_stencil_width> moved(path.width);
    for (Index element = first; element < last; ++element) {
      double* out = step.data() + element * path.rows;
      if (left_out(element)) {
        std::fill_n(out, path.rows, 0.0);
        continue;
      }
      stencils().gather(element, dx, moved.data());
      path.is_triangle() ? path.multiplier_step<3, 9>(element, penalty_, moved.data(), out)
                         : path.multiplier_step<-1, -1>(element, penalty_, moved.data(), out);
    }
  });
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
