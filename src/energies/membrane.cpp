#include "energies/membrane.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/collapse.h"
#include "linalg/symmetric2.h"

namespace taut {

Lame Lame::plane_stress(double young_modulus, double poisson_ratio) {
  return {young_modulus * poisson_ratio / (1 - poisson_ratio * poisson_ratio),
          young_modulus / (2 * (1 + poisson_ratio))};
}

Membrane::Membrane(std::string name, std::vector<RestTriangle> triangles, MembraneLaw law, Lame lame, double thickness)
    : name_(std::move(name)), triangles_(std::move(triangles)), law_(law), lame_(lame), thickness_(thickness) {
  for (const RestTriangle& triangle : triangles_) stencils_.add_vertices(triangle.vertices);
  if (law_ == MembraneLaw::stvk) quads_ = rest_quads(triangles_);
}

/// With h_j = F b_j, b_j the rows of the shape matrix, node blocks are mu ((b_j.b_k) F F^T + h_k h_j^T) + lambda h_j
/// h_k^T + (b_j.S b_k) I. All but the last are positive semidefinite together, and the last is where S is. `weight` is
/// thickness times area, `shape` the three rows b_j.
template <class Real, class Shape>
Real Membrane::evaluate_stvk(const Shape& shape, Real weight, const Real* x, Real* gradient, Real* hessian,
                             Curvature curvature) const {
  const DeformationGradient<Real> f(x, shape);
  const Real mu = weight * lame_.mu, lambda = weight * lame_.lambda;
  const Real e11 = 0.5 * (f.c11() - 1.0), e22 = 0.5 * (f.c22() - 1.0), e12 = 0.5 * f.c12(), trace = e11 + e22;
  const Real value = mu * (e11 * e11 + e22 * e22 + 2.0 * e12 * e12) + 0.5 * lambda * trace * trace;
  if (!gradient) return value;
  // First Piola-Kirchhoff stress F S with S = 2 mu E + lambda tr(E) I.
  Symmetric2<Real> s{2.0 * mu * e11 + lambda * trace, 2.0 * mu * e12, 2.0 * mu * e22 + lambda * trace};
  for (int axis = 0; axis < 3; ++axis) {
    const Real p1 = f.f1[axis] * s.a + f.f2[axis] * s.b, p2 = f.f1[axis] * s.b + f.f2[axis] * s.c;
    for (int j = 0; j < 3; ++j) gradient[3 * j + axis] = p1 * shape[j][0] + p2 * shape[j][1];
  }
  if (!hessian) return value;
  if (curvature == Curvature::positive_semidefinite) s = positive_part(s);
  std::array<std::array<Real, 3>, 3> square, h;  // mu F F^T, h_j
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      square[i][k] = mu * (f.f1[i] * f.f1[k] + f.f2[i] * f.f2[k]);
      h[k][i] = f.f1[i] * shape[k][0] + f.f2[i] * shape[k][1];
    }
  }
  for (int j = 0; j < 3; ++j) {
    const auto& b = shape[j];
    const Real sb1 = s.a * b[0] + s.b * b[1], sb2 = s.b * b[0] + s.c * b[1];
    for (int k = 0; k <= j; ++k) {
      const Real inner = b[0] * shape[k][0] + b[1] * shape[k][1];
      const Real geometric = sb1 * shape[k][0] + sb2 * shape[k][1];
      Real* lower = hessian + 27 * k + 3 * j;
      Real* upper = hessian + 27 * j + 3 * k;
      for (int column = 0; column < 3; ++column) {
        const Real mu_h = mu * h[j][column], lambda_h = lambda * h[k][column];
        for (int row = 0; row < 3; ++row) {
          Real entry = inner * square[row][column] + h[k][row] * mu_h + h[j][row] * lambda_h;
          if (row == column) entry += geometric;
          lower[9 * column + row] = entry;
          upper[9 * row + column] = entry;
        }
      }
    }
  }
  return value;
}

double Membrane::evaluate(Index element, const double* x, double* gradient, double* hessian,
                          Curvature curvature) const {
  const RestTriangle& triangle = triangles_[element];
  if (law_ == MembraneLaw::neo_hookean) return evaluate_neo_hookean(triangle, x, gradient, hessian, curvature);
  return evaluate_stvk(triangle.shape_rows(), triangle.area * thickness_, x, gradient, hessian, curvature);
}

Pack Membrane::evaluate_four(Index quad, const Pack* x, Pack* gradient, Pack* hessian, Curvature curvature) const {
  const RestQuad& four = quads_[quad];
  return evaluate_stvk(four.shape, four.area * thickness_, x, gradient, hessian, curvature);
}

double Membrane::evaluate_neo_hookean(const RestTriangle& triangle, const double* x, double* gradient, double* hessian,
                                      Curvature curvature) const {
  const Svd32 s = svd(triangle.deformation_gradient(x));
  const double weight = triangle.area * thickness_;
  const double j = s.d1 * s.d2;
  if (!(j > 0)) {
    if (gradient) std::fill_n(gradient, 9, 0.0);
    if (hessian) std::fill_n(hessian, 81, 0.0);
    return std::numeric_limits<double>::infinity();
  }
  const double log_j = std::log(j);
  const double value =
      weight * (0.5 * lame_.mu * (s.d1 * s.d1 + s.d2 * s.d2 - 2 - 2 * log_j) + 0.5 * lame_.lambda * log_j * log_j);
  const double pressure = lame_.lambda * log_j - lame_.mu;
  const double p1 = lame_.mu * s.d1 + pressure / s.d1, p2 = lame_.mu * s.d2 + pressure / s.d2;
  if (gradient) isotropic_gradient(s, triangle.shape, p1, p2, weight, gradient);
  if (hessian) {
    IsotropicDerivatives d;
    d.p1 = p1;
    d.p2 = p2;
    d.p11 = lame_.mu + (lame_.lambda - pressure) / (s.d1 * s.d1);
    d.p22 = lame_.mu + (lame_.lambda - pressure) / (s.d2 * s.d2);
    d.p12 = lame_.lambda / j;
    d.flip = lame_.mu - pressure / j;
    d.twist = lame_.mu + pressure / j;
    d.out1 = p1 / s.d1;
    d.out2 = p2 / s.d2;
    isotropic_hessian(s, triangle.shape, d, weight, curvature, hessian);
  }
  return value;
}

double Membrane::largest_step(Index /*element*/, const double* x, const double* dx) const {
  return step_before_collapse(x, dx);
}

}  // namespace taut
