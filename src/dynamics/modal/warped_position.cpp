#include "dynamics/modal/warped_position.h"

#include <cmath>
#include <numeric>

#include "dynamics/modal/modal_energies.h"
#include "dynamics/modal/warping.h"

namespace taut {

void Zero::project(Index /*element*/, const double* /*z*/, double* nearest, double* derivative) const {
  nearest[0] = 0;
  if (derivative) derivative[0] = 0;
}

void Zero::project_smoothed(Index /*element*/, const double* /*z*/, double /*epsilon*/, double* nearest,
                            double* inverse, double* rate) const {
  nearest[0] = rate[0] = 0;
  inverse[0] = 1e8;
}

void Zero::smooth_bounds(double* lower, double* upper) const { lower[0] = upper[0] = 0; }

void Zero::smooth_values(Index /*element*/, const double* z, double* g, double* jacobian) const {
  g[0] = z[0];
  if (jacobian) jacobian[0] = 1;
}

void Zero::smooth_hessian(Index /*element*/, const double* /*z*/, const double* /*weights*/, double* hessian) const {
  hessian[0] = 0;
}

WarpedPosition::WarpedPosition(std::string name, std::string body, int levels, std::shared_ptr<const ModalBasis> basis,
                               std::vector<Held> held, double size)
    : name_(std::move(name)),
      body_(std::move(body)),
      levels_(levels),
      basis_(std::move(basis)),
      held_(std::move(held)),
      size_(size),
      targets_(static_cast<Index>(held_.size())),
      stencils_(static_cast<int>(basis_->modes())) {
  std::vector<int> variables(static_cast<std::size_t>(basis_->modes()));
  std::iota(variables.begin(), variables.end(), 0);
  for (std::size_t k = 0; k < held_.size(); ++k) {
    stencils_.add(variables);
    const Index row = 3 * held_[k].node;
    shapes_.push_back(basis_->shapes.middleRows<3>(row));
    rotations_.push_back(basis_->rotations.middleRows<3>(row));
    if (!basis_->warped) rotations_.back().setZero();
    targets_[static_cast<Index>(k)] = basis_->rest[row + held_[k].axis];
  }
}

void WarpedPosition::freeze(const Vector& q) {
  frozen_.resize(3 * static_cast<Index>(held_.size()));
  for (std::size_t k = 0; k < held_.size(); ++k) frozen_.segment<3>(3 * static_cast<Index>(k)) = rotations_[k] * q;
}

Vector3 WarpedPosition::rotation(Index element, const Eigen::Map<const Vector>& q) const {
  if (frozen_.size() > 0) return frozen_.segment<3>(3 * element);
  return rotations_[static_cast<std::size_t>(element)] * q;
}

void WarpedPosition::evaluate(Index element, const double* q, double* c, double* jacobian) const {
  const Index modes = basis_->modes();
  const Eigen::Map<const Vector> at(q, modes);
  const auto k = static_cast<std::size_t>(element);
  const auto [node, axis] = held_[k];
  const Vector3 d = shapes_[k] * at, w = rotation(element, at);
  const Matrix3 integral = warp_integral(w);
  c[0] = basis_->rest[3 * node + axis] + integral.row(axis).dot(d) - targets_[element];
  if (!jacobian) return;
  Eigen::Map<Eigen::RowVectorXd> row(jacobian, modes);
  row.noalias() = integral.row(axis) * shapes_[k];
  if (frozen_.size() == 0) row.noalias() += warp_derivative(d, w).row(axis) * rotations_[k];
}

void WarpedPosition::hessian(Index element, const double* q, const double* multipliers, Curvature curvature,
                             double* hessian) const {
  const Index modes = basis_->modes();
  Eigen::Map<Matrix> sum(hessian, modes, modes);
  sum.setZero();
  if (frozen_.size() > 0) return;
  const Eigen::Map<const Vector> at(q, modes);
  const auto k = static_cast<std::size_t>(element);
  const auto &phi = shapes_[k], &psi = rotations_[k];
  Matrix6 local = warp_hessian(multipliers[0] * Vector3::Unit(held_[k].axis), phi * at, psi * at);
  if (curvature == Curvature::positive_semidefinite) local = semidefinite_part(local);
  const Matrix cross = phi.transpose() * local.topRightCorner<3, 3>() * psi;
  sum = phi.transpose() * local.topLeftCorner<3, 3>() * phi + psi.transpose() * local.bottomRightCorner<3, 3>() * psi;
  sum += cross + cross.transpose();
}

double WarpedPosition::violation(Index element, const double* q) const {
  double c = 0;
  evaluate(element, q, &c, nullptr);
  return std::abs(c);
}

std::string WarpedPosition::element_name(Index element) const {
  const auto [node, axis] = held_[static_cast<std::size_t>(element)];
  const std::string level = levels_ == 1 ? "" : " (level " + std::to_string(node % levels_) + ")";
  return std::string("the ") + "xyz"[axis] + " of vertex " + std::to_string(node / levels_) + level + " of " + body_;
}

}  // namespace taut
