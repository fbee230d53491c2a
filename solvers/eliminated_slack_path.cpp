#include "solvers/eliminated_slack_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/scratch.h"

namespace taut {

namespace {

/// Rows and width of an element's Jacobian, known to the compiler where R and W are positive.
template <int R, int W>
struct Shape {
  int all_rows, all_width;
  int rows() const { return R > 0 ? R : all_rows; }
  int width() const { return W > 0 ? W : all_width; }
};

/// task(shape) with the rows and width of triangles as constants.
template <class Task>
void with_shape(int rows, int width, const Task& task) {
  if (rows == 3 && width == 9) {
    task(Shape<3, 9>{});
  } else {
    task(Shape<0, 0>{rows, width});
  }
}

/// out = a b, a square matrix of `rows` rows.
template <class Real>
void multiply(int rows, const Real* a, const Real* b, Real* out) {
  for (int i = 0; i < rows; ++i) {
    out[i] = a[i] * b[0];
    for (int j = 1; j < rows; ++j) out[i] += a[j * rows + i] * b[j];
  }
}

/// out = w J^T lambda.
template <class Real, int R, int W>
void path_gradient(Shape<R, W> shape, Real weight, const Real* jacobian, const Real* lambda, Real* out) {
  const int rows = shape.rows();
  for (int k = 0; k < shape.width(); ++k) {
    Real sum = jacobian[k * rows] * lambda[0];
    for (int i = 1; i < rows; ++i) sum += jacobian[k * rows + i] * lambda[i];
    out[k] = weight * sum;
  }
}

/// hessian <- w (hessian + J^T W J), which is symmetric.
template <class Real, int R, int W>
void path_hessian(Shape<R, W> shape, Real weight, double penalty, const Real* jacobian, const Real* inverse,
                  Real* hessian) {
  const int rows = shape.rows(), width = shape.width();
  std::array<Real, max_rows * max_rows> w;
  for (int i = 0; i < rows * rows; ++i) w[i] = penalty * (inverse[i] - (i % (rows + 1) == 0 ? 1.0 : 0.0));
  for (int k = 0; k < width; ++k) {
    std::array<Real, max_rows> stiff;
    multiply(rows, w.data(), jacobian + k * rows, stiff.data());
    for (int l = k; l < width; ++l) {
      Real sum = hessian[k * width + l];
      for (int i = 0; i < rows; ++i) sum += jacobian[l * rows + i] * stiff[i];
      hessian[k * width + l] = hessian[l * width + k] = weight * sum;
    }
  }
}

}  // namespace

/// The multipliers of a quad, and its weights: 0 where an element is left out, for it to add nothing.
void EliminatedSlack::quad_multipliers(Index quad, Pack* lambda) const {
  const int rows = constraint_.rows();
  for (int i = 0; i < rows; ++i) {
    lambda[i] = lanes_of([&](int lane) { return multipliers_[element_of(quad, lane, weights_.size()) * rows + i]; });
  }
}

Pack EliminatedSlack::quad_weights(Index quad) const {
  return lanes_of([&](int lane) {
    const Index element = element_of(quad, lane, weights_.size());
    return left_out(element) ? 0.0 : weights_[element];
  });
}

bool EliminatedSlack::quad_left_out(Index quad) const {
  for (int lane = 0; lane < Pack::size; ++lane) {
    if (!left_out(element_of(quad, lane, weights_.size()))) return false;
  }
  return true;
}

/// c, J and the smoothed projection of one quad at its local variables x, element by element where the constraint takes
/// no four at once.
void EliminatedSlack::linearise(Index quad, const Pack* x, const Pack* lambda) {
  Path& path = *path_;
  const int rows = path.rows;
  std::array<Pack, max_rows> c, y{}, nearest{};
  if (constraint_.takes_four()) {
    constraint_.evaluate_four(quad, x, c.data(), path.jacobian[quad]);
    for (int i = 0; i < rows; ++i) y[i] = c[i] + lambda[i] / penalty_;
    constraint_.set().project_smoothed_four(quad, y.data(), path.epsilon, nearest.data(), path.inverse[quad],
                                            path.rate[quad]);
  } else {
    Scratch<max_stencil_width> local(path.width);
    Scratch<max_rows * max_stencil_width> jacobian(rows * path.width);
    std::array<double, max_rows> one_y, one_nearest, one_rate;
    std::array<double, max_rows * max_rows> inverse;
    for (int lane = 0; lane < Pack::size; ++lane) {
      const Index element = quad * Pack::size + lane;
      if (element >= weights_.size() || left_out(element)) continue;
      for (int i = 0; i < path.width; ++i) local[i] = x[i][lane];
      constraint_.evaluate(element, local.data(), one_y.data(), jacobian.data());
      for (int i = 0; i < rows; ++i) one_y[i] += lambda[i][lane] / penalty_;
      constraint_.set().project_smoothed(element, one_y.data(), path.epsilon, one_nearest.data(), inverse.data(),
                                         one_rate.data());
      path.jacobian.put(element, jacobian.data());
      path.inverse.put(element, inverse.data());
      path.rate.put(element, one_rate.data());
      for (int i = 0; i < rows; ++i) {
        y[i].lanes[lane] = one_y[i];
        nearest[i].lanes[lane] = one_nearest[i];
      }
    }
  }
  for (int i = 0; i < rows; ++i) {
    path.smoothed[quad][i] = penalty_ * (y[i] - nearest[i]);
    path.mismatch[quad][i] = lambda[i] - path.smoothed[quad][i];
  }
}

EliminatedSlack::Mismatch EliminatedSlack::set_point(const Vector& x, double epsilon, int threads) {
  if (!path_) path_ = std::make_unique<Path>(constraint_.rows(), stencils().width(), stencils().count());
  Path& path = *path_;
  path.epsilon = epsilon;
  path.for_ranges(threads, [&](Index first, Index last) {
    Scratch<max_stencil_width, Pack> local(path.width);
    std::array<Pack, max_rows> lambda;
    for (Index quad = first; quad < last; ++quad) {
      if (quad_left_out(quad)) continue;
      stencils().gather(quad, x, local.data());
      quad_multipliers(quad, lambda.data());
      linearise(quad, local.data(), lambda.data());
      Pack square = 0;
      for (int i = 0; i < path.rows; ++i) square += path.mismatch[quad][i] * path.mismatch[quad][i];
      for (int lane = 0; lane < Pack::size; ++lane) {
        const Index element = quad * Pack::size + lane;
        if (element < path.square.size()) path.square[element] = square[lane] / (penalty_ * penalty_);
      }
    }
  });
  Mismatch out;
  double weights = 0;
  for (Index element = 0; element < path.square.size(); ++element) {
    if (left_out(element)) continue;
    if (!(path.square[element] <= out.max)) out.max = path.square[element];
    out.mean_square += weights_[element] * path.square[element];
    weights += weights_[element];
  }
  out.max = std::sqrt(out.max);
  if (weights > 0) out.mean_square /= weights;
  return out;
}

void EliminatedSlack::aim(double target_epsilon, int threads, Vector& gradient) {
  Path& path = *path_;
  const double change = penalty_ * (target_epsilon - path.epsilon);
  path.for_ranges(threads, [&](Index first, Index last) {
    std::array<Pack, max_rows> f;
    for (Index quad = first; quad < last; ++quad) {
      if (quad_left_out(quad)) continue;
      for (int i = 0; i < path.rows; ++i) f[i] = path.mismatch[quad][i] + change * path.rate[quad][i];
      multiply(path.rows, path.inverse[quad], f.data(), path.correction[quad]);
    }
  });
  Scratch<max_stencil_width, Pack> force(path.width);
  for (Index quad = 0; quad < quads(path.square.size()); ++quad) {
    if (quad_left_out(quad)) continue;
    with_shape(path.rows, path.width, [&](auto shape) {
      path_gradient(shape, quad_weights(quad), path.jacobian[quad], path.correction[quad], force.data());
    });
    for (int lane = 0; lane < Pack::size; ++lane) {
      const Index element = quad * Pack::size + lane;
      if (element >= path.square.size() || left_out(element)) continue;
      const int* variables = stencils()[element];
      for (int k = 0; k < path.width; ++k) gradient[variables[k]] -= force[k][lane];
    }
  }
}

double EliminatedSlack::evaluate_path(Index element, const double* x, double* gradient, double* hessian,
                                      Curvature curvature) const {
  if (!gradient) return 0;
  const Path& path = *path_;
  const int rows = path.rows;
  Scratch<max_rows * max_stencil_width> jacobian(rows * path.width);
  path.jacobian.get(element, jacobian.data());
  std::array<double, max_rows * max_rows> inverse;
  std::array<double, max_rows> smoothed;
  path.inverse.get(element, inverse.data());
  path.smoothed.get(element, smoothed.data());
  if (hessian) constraint_.hessian(element, x, smoothed.data(), curvature, hessian);
  with_shape(rows, path.width, [&](auto shape) {
    path_gradient(shape, weights_[element], jacobian.data(), multipliers_.data() + element * rows, gradient);
    if (hessian) path_hessian(shape, weights_[element], penalty_, jacobian.data(), inverse.data(), hessian);
  });
  return 0;
}

Pack EliminatedSlack::evaluate_four(Index quad, const Pack* x, Pack* gradient, Pack* hessian,
                                    Curvature curvature) const {
  const Path& path = *path_;
  if (!gradient) return 0;
  if (quad_left_out(quad)) {
    std::fill_n(gradient, path.width, Pack(0.0));
    if (hessian) std::fill_n(hessian, path.width * path.width, Pack(0.0));
    return 0;
  }
  std::array<Pack, max_rows> lambda;
  quad_multipliers(quad, lambda.data());
  const Pack weights = quad_weights(quad);
  if (hessian) constraint_.hessian_four(quad, x, path.smoothed[quad], curvature, hessian);
  with_shape(path.rows, path.width, [&](auto shape) {
    path_gradient(shape, weights, path.jacobian[quad], lambda.data(), gradient);
    if (hessian) path_hessian(shape, weights, penalty_, path.jacobian[quad], path.inverse[quad], hessian);
  });
  return 0;
}

void EliminatedSlack::multiplier_step(const Vector& dx, int threads, Vector& step) const {
  const Path& path = *path_;
  step.resize(multipliers_.size());
  path.for_ranges(threads, [&](Index first, Index last) {
    Scratch<max_stencil_width, Pack> moved(path.width);
    std::array<Pack, max_rows> change, out;
    for (Index quad = first; quad < last; ++quad) {
      stencils().gather(quad, dx, moved.data());
      const Pack* jacobian = path.jacobian[quad];
      for (int i = 0; i < path.rows; ++i) {
        change[i] = jacobian[i] * moved[0];
        for (int k = 1; k < path.width; ++k) change[i] += jacobian[k * path.rows + i] * moved[k];
      }
      multiply(path.rows, path.inverse[quad], change.data(), out.data());
      for (int i = 0; i < path.rows; ++i) out[i] = penalty_ * (out[i] - change[i]) - path.correction[quad][i];
      for (int lane = 0; lane < Pack::size; ++lane) {
        const Index element = quad * Pack::size + lane;
        if (element >= path.square.size()) continue;
        for (int i = 0; i < path.rows; ++i) step[element * path.rows + i] = left_out(element) ? 0.0 : out[i][lane];
      }
    }
  });
}

}  // namespace taut
