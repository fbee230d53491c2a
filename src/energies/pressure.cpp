#include "energies/pressure.h"

namespace taut {

Pressure::Pressure(std::string name, const std::vector<Triangle>& triangles, double pressure)
    : name_(std::move(name)), pressure_(pressure) {
  for (const Triangle& triangle : triangles) stencils_.add_vertices(triangle);
}

double Pressure::evaluate(Index /*element*/, const double* x, double* gradient, double* hessian,
                          Curvature curvature) const {
  const Eigen::Map<const Matrix3> p(x);
  const double scale = -factor_ * pressure_ / 6;
  if (gradient) {
    Eigen::Map<Matrix3> g(gradient);
    for (int j = 0; j < 3; ++j) g.col(j) = scale * p.col((j + 1) % 3).cross(p.col((j + 2) % 3));
  }
  if (hessian) {
    Eigen::Map<Eigen::Matrix<double, 9, 9>> h(hessian);
    h.setZero();
    if (curvature == Curvature::exact) {
      for (int j = 0; j < 3; ++j) {
        // d(x_k x x_l)/dx_k = -[x_l]x, d/dx_l = [x_k]x with k = j + 1, l = j + 2.
        const int k = (j + 1) % 3, l = (j + 2) % 3;
        for (int c = 0; c < 3; ++c) {
          h.block<3, 1>(3 * j, 3 * k + c) = scale * Vector3::Unit(c).cross(p.col(l));
          h.block<3, 1>(3 * j, 3 * l + c) = scale * p.col(k).cross(Vector3::Unit(c));
        }
      }
    }
  }
  return scale * p.col(0).dot(p.col(1).cross(p.col(2)));
}

}  // namespace taut
