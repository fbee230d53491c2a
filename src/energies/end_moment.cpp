#include "energies/end_moment.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace taut {

EndMoment::EndMoment(std::string name, std::vector<Load> loads, const Vector3& axis, const Vector& x)
    : name_(std::move(name)), loads_(std::move(loads)), axis_(axis.normalized()) {
  if (!(axis.norm() > 0)) throw std::invalid_argument("EndMoment: expected an axis with a length");
  for (const Load& load : loads_) {
    stencils_.add_vertices(std::array{load.bottom, load.top});
    const Vector3 director = x.segment<3>(3 * load.top) - x.segment<3>(3 * load.bottom);
    const Vector3 across = director - axis_.dot(director) * axis_;
    if (!(across.norm() > 1e-9 * director.norm())) {
      throw std::invalid_argument("EndMoment: expected directors across the axis, got one along it at node " +
                                  std::to_string(load.bottom));
    }
    reference_.push_back(across.normalized());
  }
}

double EndMoment::turned(Index element, const Vector3& director) const {
  const Vector3& r = reference_[element];
  return std::atan2(axis_.cross(r).dot(director), r.dot(director));
}

void EndMoment::set_reference(const Vector& x) {
  for (std::size_t k = 0; k < loads_.size(); ++k) {
    const Vector3 director = x.segment<3>(3 * loads_[k].top) - x.segment<3>(3 * loads_[k].bottom);
    reference_[k] = (director - axis_.dot(director) * axis_).normalized();
  }
}

double EndMoment::evaluate(Index element, const double* x, double* gradient, double* hessian,
                           Curvature curvature) const {
  const Eigen::Map<const Vector3> bottom(x), top(x + 3);
  const Vector3 director = top - bottom;
  const double moment = factor_ * loads_[element].moment;
  const Vector3 p = reference_[element], q = axis_.cross(p);
  const double u = p.dot(director), v = q.dot(director), square = u * u + v * v;
  if (gradient) {
    const Vector3 force = -moment / square * (u * q - v * p);
    for (int axis = 0; axis < 3; ++axis) {
      gradient[axis] = -force[axis];
      gradient[axis + 3] = force[axis];
    }
  }
  if (hessian) {
    // Eigenvalues +-m/r^2; the semidefinite form keeps the positive one.
    Matrix2 plane;
    plane << 2 * u * v, v * v - u * u, v * v - u * u, -2 * u * v;
    plane *= -moment / (square * square);
    if (curvature == Curvature::positive_semidefinite) {
      plane = 0.5 * (plane + std::abs(moment) / square * Matrix2::Identity()).eval();
    }
    Eigen::Matrix<double, 2, 6> change;
    for (int axis = 0; axis < 3; ++axis) {
      change.col(axis) << -p[axis], -q[axis];
      change.col(axis + 3) << p[axis], q[axis];
    }
    Eigen::Map<Eigen::Matrix<double, 6, 6>> h(hessian);
    h = change.transpose() * plane * change;
  }
  return -moment * turned(element, director);
}

}  // namespace taut
