#include "constraints/strain_limit.h"

#include <algorithm>
#include <numbers>
#include <stdexcept>

#include "geometry/collapse.h"
#include "linalg/symmetric2.h"

namespace taut {
namespace {

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
      stencils_(triangle_stencils(limit_.triangles)),
      quads_(rest_quads(limit_.triangles)) {
  check(limit_);
}

namespace {

/// C = F^T F in the coordinates (C11, sqrt2 C12, C22) of one triangle or four, and where not null its Jacobian.
template <class Real, class Shape>
void evaluate_strain(const Shape& shape, const Real* x, Real* c, Real* jacobian) {
  constexpr double root2 = std::numbers::sqrt2;
  const DeformationGradient<Real> f(x, shape);
  c[0] = f.c11();
  c[1] = root2 * f.c12();
  c[2] = f.c22();
  if (!jacobian) return;
  for (int j = 0; j < 3; ++j) {
    const Real b1 = 2.0 * shape[j][0], b2 = 2.0 * shape[j][1], d1 = root2 * shape[j][0], d2 = root2 * shape[j][1];
    for (int axis = 0; axis < 3; ++axis) {
      Real* column = jacobian + 3 * (3 * j + axis);
      column[0] = b1 * f.f1[axis];
      column[1] = d1 * f.f2[axis] + d2 * f.f1[axis];
      column[2] = b2 * f.f2[axis];
    }
  }
}

/// Of the multipliers times the coordinates above: diagonal blocks b_j . T b_k with T twice the multiplier matrix.
template <class Real, class Shape>
void strain_hessian(const Shape& shape, const Real* multipliers, Curvature curvature, Real* hessian) {
  Symmetric2<Real> tension{2.0 * multipliers[0], std::numbers::sqrt2 * multipliers[1], 2.0 * multipliers[2]};
  if (curvature == Curvature::positive_semidefinite) tension = positive_part(tension);
  std::fill_n(hessian, 81, Real(0.0));
  for (int j = 0; j < 3; ++j) {
    const Real pulled1 = tension.a * shape[j][0] + tension.b * shape[j][1];
    const Real pulled2 = tension.b * shape[j][0] + tension.c * shape[j][1];
    for (int k = 0; k < 3; ++k) {
      const Real entry = shape[k][0] * pulled1 + shape[k][1] * pulled2;
      for (int axis = 0; axis < 3; ++axis) hessian[9 * (3 * k + axis) + 3 * j + axis] = entry;
    }
  }
}

}  // namespace

void MatrixStrainLimit::evaluate(Index element, const double* x, double* c, double* jacobian) const {
  evaluate_strain(limit_.triangles[element].shape_rows(), x, c, jacobian);
}

void MatrixStrainLimit::evaluate_four(Index quad, const Pack* x, Pack* c, Pack* jacobian) const {
  evaluate_strain(quads_[quad].shape, x, c, jacobian);
}

void MatrixStrainLimit::hessian(Index element, const double* /*x*/, const double* multipliers, Curvature curvature,
                                double* hessian) const {
  strain_hessian(limit_.triangles[element].shape_rows(), multipliers, curvature, hessian);
}

void MatrixStrainLimit::hessian_four(Index quad, const Pack* /*x*/, const Pack* multipliers, Curvature curvature,
                                     Pack* hessian) const {
  strain_hessian(quads_[quad].shape, multipliers, curvature, hessian);
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
