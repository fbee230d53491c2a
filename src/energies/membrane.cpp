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
}

double Membrane::evaluate(Index element, const double* x, double* gradient, double* hessian,
                          Curvature curvature) const {
  const RestTriangle& triangle = triangles_[element];
  return law_ == MembraneLaw::stvk ? evaluate_stvk(triangle, x, gradient, hessian, curvature)
                                   : evaluate_neo_hookean(triangle, x, gradient, hessian, curvature);
}

/// With h_j = F b_j, b_j the rows of the shape matrix, node blocks are mu ((b_j.b_k) F F^T + h_k h_j^T) + lambda h_j
/// h_k^T + (b_j.S b_k) I. All but the last are positive semidefinite together, and the last is where S is.
double Membrane::evaluate_stvk(const RestTriangle& triangle, const double* x, double* gradient, double* hessian,
                               Curvature curvature) const {
  const Matrix32 f = triangle.deformation_gradient(x);
  const double weight = triangle.area * thickness_;
  const double e11 = 0.5 * (f.col(0).squaredNorm() - 1), e22 = 0.5 * (f.col(1).squaredNorm() - 1),
               e12 = 0.5 * f.col(0).dot(f.col(1));
  const double trace = e11 + e22;
  const double value =
      weight * (lame_.mu * (e11 * e11 + e22 * e22 + 2 * e12 * e12) + 0.5 * lame_.lambda * trace * trace);
  if (!gradient) return value;
  // First Piola-Kirchhoff stress P = F S with S = 2 mu E + lambda tr(E) I.
  Matrix2 s;
  s(0, 0) = weight * (2 * lame_.mu * e11 + lame_.lambda * trace);
  s(1, 1) = weight * (2 * lame_.mu * e22 + lame_.lambda * trace);
  s(0, 1) = s(1, 0) = weight * 2 * lame_.mu * e12;
  const Matrix32 p = f * s;
  Eigen::Map<Matrix3>(gradient).noalias() = p * triangle.shape.transpose();
  if (!hessian) return value;
  if (curvature == Curvature::positive_semidefinite) s = positive_part(s);
  const double mu = weight * lame_.mu, lambda = weight * lame_.lambda;
  const Matrix3 square = mu * (f * f.transpose()), h = f * triangle.shape.transpose();
  for (int j = 0; j < 3; ++j) {
    const Vector2 b = triangle.shape.row(j), sb = s * b;
    const double* hj = h.data() + 3 * j;
    for (int k = 0; k <= j; ++k) {
      const double inner = b.dot(triangle.shape.row(k)), geometric = sb.dot(triangle.shape.row(k));
      const double* hk = h.data() + 3 * k;
      double* lower = hessian + 27 * k + 3 * j;
      double* upper = hessian + 27 * j + 3 * k;
      for (int column = 0; column < 3; ++column) {
        const double mu_h = mu * hj[column], lambda_h = lambda * hk[column];
        for (int row = 0; row < 3; ++row) {
          double entry = inner * square(row, column) + hk[row] * mu_h + hj[row] * lambda_h;
          if (row == column) entry += geometric;
          lower[9 * column + row] = entry;
          upper[9 * row + column] = entry;
        }
      }
    }
  }
  return value;
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
