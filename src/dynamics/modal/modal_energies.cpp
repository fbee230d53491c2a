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

WarpedLoad::WarpedLoad(std::string name, const ModalBasis& basis, const Vector& forces)
    : name_(std::move(name)), stencils_(all_modes(basis.modes())) {
  std::vector<Index> loaded;
  for (Index node = 0; node < basis.nodes(); ++node) {
    if (!forces.segment<3>(3 * node).isZero(0)) loaded.push_back(node);
  }
  const auto count = static_cast<Index>(loaded.size());
  shapes_.resize(basis.modes(), 3 * count);
  rotations_ = Matrix::Zero(basis.modes(), 3 * count);
  forces_.resize(3 * count);
  for (Index i = 0; i < count; ++i) {
    const Index node = loaded[static_cast<std::size_t>(i)];
    shapes_.middleCols<3>(3 * i) = basis.shapes.middleRows<3>(3 * node).transpose();
    if (basis.warped) rotations_.middleCols<3>(3 * i) = basis.rotations.middleRows<3>(3 * node).transpose();
    forces_.segment<3>(3 * i) = forces.segment<3>(3 * node);
  }
}

void WarpedLoad::freeze(const Vector& q) {
  const Vector w = rotations_.transpose() * q;
  Vector turned = forces_;
  for (Index i = 0; i < forces_.size(); i += 3) {
    turned.segment<3>(i) = warp_integral(w.segment<3>(i)).transpose() * forces_.segment<3>(i);
  }
  frozen_force_ = shapes_ * turned;
}

double WarpedLoad::evaluate(Index /*element*/, const double* q, double* gradient, double* hessian,
                            Curvature curvature) const {
  const Index modes = shapes_.rows();
  const Eigen::Map<const Vector> at(q, modes);
  if (frozen_force_.size() > 0) {
    if (gradient) Eigen::Map<Vector>(gradient, modes) = -factor_ * frozen_force_;
    if (hessian) Eigen::Map<Matrix>(hessian, modes, modes).setZero();
    return -factor_ * frozen_force_.dot(at);
  }
  const Vector d = shapes_.transpose() * at, w = rotations_.transpose() * at;
  double value = 0;
  Vector by_d(d.size()), by_w(d.size());
  Matrix half(modes, hessian ? d.size() : 0);
  for (Index i = 0; i < d.size(); i += 3) {
    const Vector3 f = -factor_ * forces_.segment<3>(i), di = d.segment<3>(i), wi = w.segment<3>(i);
    const Matrix3 integral = warp_integral(wi);
    value += f.dot(integral * di);
    if (gradient) {
      by_d.segment<3>(i) = integral.transpose() * f;
      by_w.segment<3>(i) = warp_derivative(di, wi).transpose() * f;
    }
    if (!hessian) continue;
    // Of f.R~(w) d the second derivative in d is zero: what is left is Phi^T B Psi, its transpose, and Psi^T C Psi.
    const Matrix6 local = warp_hessian(f, di, wi);
    const Matrix3 mixed = local.topRightCorner<3, 3>(), turning = 0.5 * local.bottomRightCorner<3, 3>();
    half.middleCols<3>(i).noalias() = shapes_.middleCols<3>(i).lazyProduct(mixed);
    half.middleCols<3>(i).noalias() += rotations_.middleCols<3>(i).lazyProduct(turning);
  }
  if (gradient) Eigen::Map<Vector>(gradient, modes) = shapes_ * by_d + rotations_ * by_w;
  if (hessian) {
    const Matrix sum = half * rotations_.transpose();
    Eigen::Map<Matrix> all(hessian, modes, modes);
    all = sum + sum.transpose();
    if (curvature == Curvature::positive_semidefinite) all = semidefinite_part(all);
  }
  return value;
}

}  // namespace taut
