#include "constraints/strain_limit.h"

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "geometry/collapse.h"
#include "linalg/symmetric2.h"

namespace taut {
namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;

Stencils triangle_stencils(const std::vector<RestTriangle>& triangles) {
  Stencils stencils(9);
  for (const RestTriangle& triangle : triangles) stencils.add_vertices(triangle.vertices);
  return stencils;
}

void check(const StrainLimitTriangles& limit) {
  if (!(limit.min >= 0 && limit.min <= limit.max && limit.max > 0)) {
    throw std::invalid_argument("strain limit " + limit.constraint + ": expected 0 <= min <= max, got min " +
                                std::to_string(limit.min) + ", max " + std::to_string(limit.max));
  }
  if (limit.ids.size() != limit.triangles.size()) {
    throw std::invalid_argument("strain limit " + limit.constraint + ": " + std::to_string(limit.ids.size()) +
                                " ids for " + std::to_string(limit.triangles.size()) + " triangles");
  }
}

/// The lower bound of the set: minus infinity where there is no lower limit, so that round-off below zero never counts
/// as active.
double lower_bound(double min, double value) { return min > 0 ? value : -std::numeric_limits<double>::infinity(); }

}  // namespace

double StrainLimitTriangles::violation(Index element, const double* x) const {
  const Vector2 d = singular_values(triangles[element].deformation_gradient(x));
  if (!d.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  return std::max({d[0] - max, min - d[1], 0.0});
}

std::string StrainLimitTriangles::element_name(Index element) const {
  return "triangle " + std::to_string(ids[element]) + " of " + body;
}

MatrixStrainLimit::MatrixStrainLimit(StrainLimitTriangles limit)
    : limit_(std::move(limit)),
      set_(lower_bound(limit_.min, limit_.min * limit_.min), limit_.max * limit_.max),
      stencils_(triangle_stencils(limit_.triangles)) {
  check(limit_);
}

void MatrixStrainLimit::evaluate(Index element, const double* x, double* c, double* jacobian) const {
  constexpr double root2 = std::numbers::sqrt2;
  const RestTriangle& triangle = limit_.triangles[element];
  const Matrix32 f = triangle.deformation_gradient(x);
  c[0] = f.col(0).squaredNorm();
  c[1] = root2 * f.col(0).dot(f.col(1));
  c[2] = f.col(1).squaredNorm();
  if (!jacobian) return;
  for (int j = 0; j < 3; ++j) {
    const double b1 = triangle.shape(j, 0), b2 = triangle.shape(j, 1);
    for (int axis = 0; axis < 3; ++axis) {
      double* column = jacobian + 3 * (3 * j + axis);
      column[0] = 2 * b1 * f(axis, 0);
      column[1] = root2 * (b1 * f(axis, 1) + b2 * f(axis, 0));
      column[2] = 2 * b2 * f(axis, 1);
    }
  }
}

void MatrixStrainLimit::hessian(Index element, const double* /*x*/, const double* multipliers, Curvature curvature,
                                double* hessian) const {
  const TriangleShape& shape = limit_.triangles[element].shape;
  Matrix2 tension;
  tension << multipliers[0], multipliers[1] / std::numbers::sqrt2, multipliers[1] / std::numbers::sqrt2, multipliers[2];
  if (curvature == Curvature::positive_semidefinite) tension = positive_part(tension);
  Eigen::Map<Matrix9> h(hessian);
  h.setZero();
  for (int j = 0; j < 3; ++j) {
    const Vector2 pulled = 2 * tension * shape.row(j).transpose();
    for (int k = 0; k < 3; ++k) h.block<3, 3>(3 * j, 3 * k).diagonal().setConstant(shape.row(k).dot(pulled));
  }
}

double MatrixStrainLimit::largest_step(Index /*element*/, const double* x, const double* dx) const {
  return step_before_collapse(x, dx);
}

SingularValueStrainLimit::SingularValueStrainLimit(StrainLimitTriangles limit)
    : limit_(std::move(limit)),
      set_(2, lower_bound(limit_.min, limit_.min), limit_.max),
      stencils_(triangle_stencils(limit_.triangles)) {
  check(limit_);
}

void SingularValueStrainLimit::evaluate(Index element, const double* x, double* c, double* jacobian) const {
  const RestTriangle& triangle = limit_.triangles[element];
  const Svd32 s = svd(triangle.deformation_gradient(x));
  c[0] = s.d1;
  c[1] = s.d2;
  if (!jacobian) return;
  const Vector3 b1 = triangle.shape * s.v1, b2 = triangle.shape * s.v2;
  for (int j = 0; j < 3; ++j) {
    for (int axis = 0; axis < 3; ++axis) {
      double* column = jacobian + 2 * (3 * j + axis);
      column[0] = b1[j] * s.u1[axis];
      column[1] = b2[j] * s.u2[axis];
    }
  }
}

void SingularValueStrainLimit::hessian(Index element, const double* x, const double* multipliers, Curvature curvature,
                                       double* hessian) const {
  const RestTriangle& triangle = limit_.triangles[element];
  const Svd32 s = svd(triangle.deformation_gradient(x));
  // The second derivatives are unbounded at d1 = d2 and at d2 = 0; the floor only keeps them representable.
  const double floor = 1e-12 * std::max(s.d1, 1e-300);
  IsotropicDerivatives d{};
  d.p1 = multipliers[0];
  d.p2 = multipliers[1];
  d.flip = (d.p1 - d.p2) / std::max(s.d1 - s.d2, floor);
  d.twist = (d.p1 + d.p2) / std::max(s.d1 + s.d2, floor);
  d.out1 = d.p1 / std::max(s.d1, floor);
  d.out2 = d.p2 / std::max(s.d2, floor);
  isotropic_hessian(s, triangle.shape, d, 1.0, curvature, hessian);
}

double SingularValueStrainLimit::largest_step(Index /*element*/, const double* x, const double* dx) const {
  return step_before_collapse(x, dx);
}

}  // namespace taut
