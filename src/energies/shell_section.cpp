#include "energies/shell_section.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

#include "energies/prism_quadrature.h"

namespace taut {
namespace {

const Vector3 centre = Vector3::Constant(1.0 / 3);

/// The tensor of a stress in Voigt's order, or with half of its shear of a strain.
Matrix3 tensor(const Voigt& v, double shear) {
  Matrix3 t;
  t << v[0], shear * v[3], shear * v[4], shear * v[3], v[1], shear * v[5], shear * v[4], shear * v[5], v[2];
  return t;
}

std::array<Vector3, 6> points_of(const Prism& prism, const std::vector<Vector3>& nodes) {
  std::array<Vector3, 6> points;
  for (int j = 0; j < 6; ++j) points[j] = nodes[prism[j]];
  return points;
}

}  // namespace

ShellSection::ShellSection(std::vector<Layer> layers, const std::vector<Prism>& prisms,
                           const std::vector<Vector3>& nodes, const Vector3& direction)
    : layers_(std::move(layers)) {
  int levels = 0;
  for (const Layer& layer : layers_) levels += layer.prisms;
  const int triangles = static_cast<int>(prisms.size()) / levels;
  for (const Layer& layer : layers_) {
    for (int p = 0; p < layer.prisms; ++p) levels_.push_back({layer.energy, p * triangles});
  }
  shapes_.reserve(prisms.size());
  for (const Prism& prism : prisms) shapes_.emplace_back(points_of(prism, nodes));
  for (int t = 0; t < triangles; ++t) {
    const Prism &bottom = prisms[t],
                &top = prisms[static_cast<std::size_t>(levels - 1) * static_cast<std::size_t>(triangles) +
                              static_cast<std::size_t>(t)];
    Matrix3 mid;
    for (int j = 0; j < 3; ++j) mid.col(j) = 0.5 * (nodes[bottom[2 * j]] + nodes[top[2 * j + 1]]);
    const Vector3 across = (mid.col(1) - mid.col(0)).cross(mid.col(2) - mid.col(0)), normal = across.normalized();
    Vector3 axis = direction - direction.dot(normal) * normal;
    if (!(axis.norm() > 0.0175 * direction.norm())) axis = mid.col(1) - mid.col(0);
    Matrix3& axes = axes_.emplace_back();
    axes.col(0) = axis.normalized();
    axes.col(1) = normal.cross(axes.col(0));
    axes.col(2) = normal;
    areas_.push_back(0.5 * across.norm());
    middles_.push_back(mid * centre);
  }
}

PrismState ShellSection::state_at(int triangle, int level, double gamma, const Vector& x) const {
  const Level& at = levels_[level];
  std::array<double, 18> local;
  at.energy->stencils().gather(at.first + triangle, x, local.data());
  return at.energy->state(at.first + triangle, local.data(), centre, gamma);
}

Matrix3 ShellSection::stress_in_axes(int triangle, const PrismState& state) const {
  const Matrix3 turn = axes(triangle).transpose() * state.frame;
  return turn * tensor(state.stress, 1) * turn.transpose();
}

Resultants ShellSection::resultants(int triangle, const Vector& x) const {
  Resultants sum{Vector3::Zero(), Vector3::Zero(), Vector2::Zero()};
  for (int level = 0; level < static_cast<int>(levels_.size()); ++level) {
    const PrismShape& shape =
        shapes_[static_cast<std::size_t>(level) * axes_.size() + static_cast<std::size_t>(triangle)];
    const PrismJacobian jacobian(shape);
    for (const LinePoint& line : gauss_rule(3)) {
      const Matrix3 s = stress_in_axes(triangle, state_at(triangle, level, line.gamma, x));
      const double z =
          axes(triangle).col(2).dot((shape.mid + line.gamma * shape.director) * centre - middles_[triangle]);
      // Volume per area of the mid-surface.
      const double height =
          line.weight / (2 * area(triangle)) *
          (jacobian.g.sum() / 3 + line.gamma * jacobian.h.sum() / 3 + line.gamma * line.gamma * jacobian.i);
      const Vector3 in_plane(s(0, 0), s(1, 1), s(0, 1));
      sum.n += height * in_plane;
      sum.m += height * z * in_plane;
      sum.q += height * Vector2(s(0, 2), s(1, 2));
    }
  }
  return sum;
}

LayerState ShellSection::state(int triangle, int layer, double gamma, const Vector& x) const {
  int level = 0;
  for (int k = 0; k < layer; ++k) level += layers_[k].prisms;
  const double height = 0.5 * (gamma + 1) * layers_[layer].prisms;  // in prisms
  const int above = std::min(static_cast<int>(height), layers_[layer].prisms - 1);
  const PrismState state = state_at(triangle, level + above, 2 * (height - above) - 1, x);
  const Matrix3 s = stress_in_axes(triangle, state);
  const Matrix3 c = Matrix3::Identity() + 2 * tensor(state.strain, 0.5);
  const Vector3 squares = Eigen::SelfAdjointEigenSolver<Matrix3>(c, Eigen::EigenvaluesOnly).eigenvalues();
  LayerState result;
  result.stress << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(0, 2), s(1, 2);
  result.stretches = squares.reverse().cwiseSqrt();
  return result;
}

}  // namespace taut
