#include "dynamics/modal/modal_energies.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <numeric>

#include "dynamics/modal/warping.h"

namespace taut {

Stencils all_modes(Index count) {
  Stencils stencils(static_cast<int>(count));
  std::vector<int> variables(static_cast<std::size_t>(count));
  std::iota(variables.begin(), variables.end(), 0);
  stencils.add(variables);
  return stencils;
}

Matrix semidefinite_part(const Matrix& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
}

ModalStiffness::ModalStiffness(std::string name, Vector stiffness)
    : name_(std::move(name)), stiffness_(std::move(stiffness)) {
  for (int k = 0; k < static_cast<int>(stiffness_.size()); ++k) stencils_.add(std::array{k});
}

double ModalStiffness::evaluate(Index element, const double* q, double* gradient, double* hessian,
                                Curvature /*curvature*/) const {
  const double force = stiffness_[element] * q[0];
  if (gradient) gradient[0] = force;
  if (hessian) hessian[0] = stiffness_[element];
  return 0.5 * force * q[0];
}

WarpedLoad::WarpedLoad(std::string name, std::shared_ptr<const ModalBasis> basis, Vector forces)
    : name_(std::move(name)), basis_(std::move(basis)), stencils_(all_modes(basis_->modes())) {
  for (Index node = 0; node < basis_->nodes(); ++node) {
    if (!forces.segment<3>(3 * node).isZero(0)) nodes_.push_back(node);
  }
  const auto count = static_cast<Index>(nodes_.size());
  shapes_.resize(3 * count, basis_->modes());
  rotations_.resize(3 * count, basis_->modes());
  forces_.resize(3 * count);
  for (Index i = 0; i < count; ++i) {
    const Index node = nodes_[static_cast<std::size_t>(i)];
    shapes_.middleRows<3>(3 * i) = basis_->shapes.middleRows<3>(3 * node);
    rotations_.middleRows<3>(3 * i) = basis_->rotations.middleRows<3>(3 * node);
    forces_.segment<3>(3 * i) = forces.segment<3>(3 * node);
  }
  if (!basis_->warped) rotations_.setZero();
}

void WarpedLoad::freeze(const Vector& q) {
  const Vector w = rotations_ * q;
  Vector turned = forces_;
  for (Index i = 0; i < forces_.size(); i += 3) {
    turned.segment<3>(i) = warp_integral(w.segment<3>(i)).transpose() * forces_.segment<3>(i);
  }
  frozen_force_ = shapes_.transpose() * turned;
  frozen_ = true;
}

double WarpedLoad::evaluate(Index /*element*/, const double* q, double* gradient, double* hessian,
                            Curvature curvature) const {
  const Index modes = basis_->modes();
  const Eigen::Map<const Vector> at(q, modes);
  if (frozen_) {
    if (gradient) Eigen::Map<Vector>(gradient, modes) = -factor_ * frozen_force_;
    if (hessian) Eigen::Map<Matrix>(hessian, modes, modes).setZero();
    return -factor_ * frozen_force_.dot(at);
  }
  const Vector d = shapes_ * at, w = rotations_ * at;
  double value = 0;
  Vector by_d(d.size()), by_w(d.size());
  Matrix shapes_part(hessian ? d.size() : 0, modes), rotations_part(hessian ? d.size() : 0, modes);
  for (Index i = 0; i < d.size(); i += 3) {
    const Vector3 f = -factor_ * forces_.segment<3>(i), di = d.segment<3>(i), wi = w.segment<3>(i);
    const Matrix3 integral = warp_integral(wi);
    value += f.dot(integral * di);
    if (!gradient) continue;
    by_d.segment<3>(i) = integral.transpose() * f;
    by_w.segment<3>(i) = warp_derivative(di, wi).transpose() * f;
    if (!hessian) continue;
    Matrix6 local = warp_hessian(f, di, wi);
    if (curvature == Curvature::positive_semidefinite) local = semidefinite_part(local);
    const auto phi = shapes_.middleRows<3>(i), psi = rotations_.middleRows<3>(i);
    shapes_part.middleRows<3>(i) = local.topLeftCorner<3, 3>() * phi + local.topRightCorner<3, 3>() * psi;
    rotations_part.middleRows<3>(i) = local.bottomLeftCorner<3, 3>() * phi + local.bottomRightCorner<3, 3>() * psi;
  }
  if (gradient) Eigen::Map<Vector>(gradient, modes) = shapes_.transpose() * by_d + rotations_.transpose() * by_w;
  if (hessian) {
    Matrix sum = shapes_.transpose() * shapes_part;
    sum += rotations_.transpose() * rotations_part;
    Eigen::Map<Matrix>(hessian, modes, modes) = 0.5 * (sum + sum.transpose());
  }
  return value;
}

}  // namespace taut
