#include "energies/stiffness_damping.h"

#include <array>

namespace taut {

StiffnessDamping::StiffnessDamping(std::string name, const Energy& energy) : name_(std::move(name)), energy_(energy) {
  const Stencils& stencils = energy_.stencils();
  stiffness_.resize(static_cast<std::size_t>(stencils.count() * stencils.width() * stencils.width()));
}

void StiffnessDamping::set_reference(double coefficient, const Vector& positions, const Vector& origin) {
  coefficient_ = coefficient;
  origin_ = origin;
  const Stencils& stencils = energy_.stencils();
  std::array<double, max_stencil_width> local, gradient;
  for (Index element = 0; element < stencils.count(); ++element) {
    stencils.gather(element, positions, local.data());
    double* stiffness = stiffness_.data() + element * stencils.width() * stencils.width();
    energy_.evaluate(element, local.data(), gradient.data(), stiffness, Curvature::positive_semidefinite);
  }
}

double StiffnessDamping::evaluate(Index element, const double* x, double* gradient, double* hessian,
                                  Curvature /*curvature*/) const {
  const Stencils& stencils = energy_.stencils();
  const int width = stencils.width();
  const Eigen::Map<const Matrix> stiffness(stiffness_.data() + element * width * width, width, width);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, max_stencil_width, 1> moved(width), force(width);
  for (int i = 0; i < width; ++i) moved[i] = x[i] - origin_[stencils[element][i]];
  force.noalias() = coefficient_ * stiffness.lazyProduct(moved);
  if (gradient) Eigen::Map<Vector>(gradient, width) = force;
  if (hessian) Eigen::Map<Matrix>(hessian, width, width) = coefficient_ * stiffness;
  return 0.5 * moved.dot(force);
}

}  // namespace taut
