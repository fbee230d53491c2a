#include "constraints/obstacle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace taut {

Obstacle::Obstacle(std::string name, std::string body, std::vector<int> vertices, int first_vertex, double scene_size)
    : name_(std::move(name)),
      body_(std::move(body)),
      vertices_(std::move(vertices)),
      first_vertex_(first_vertex),
      scene_size_(scene_size),
      set_(1, 0.0, std::numeric_limits<double>::infinity()) {
  for (int vertex : vertices_) stencils_.add_vertices(std::array{vertex});
}

double Obstacle::violation(Index element, const double* x) const {
  double gap;
  evaluate(element, x, &gap, nullptr);
  return std::isnan(gap) ? gap : std::max(-gap, 0.0);
}

std::string Obstacle::element_name(Index element) const {
  return "vertex " + std::to_string(vertices_[element] - first_vertex_) + " of " + body_;
}

HalfSpace::HalfSpace(std::string name, std::string body, std::vector<int> vertices, int first_vertex, double scene_size)
    : Obstacle(std::move(name), std::move(body), std::move(vertices), first_vertex, scene_size) {}

void HalfSpace::place(const Vector3& point, const Vector3& normal) {
  point_ = point;
  normal_ = normal.normalized();
}

void HalfSpace::evaluate(Index /*element*/, const double* x, double* c, double* jacobian) const {
  c[0] = normal_.dot(Eigen::Map<const Vector3>(x) - point_);
  if (jacobian) Eigen::Map<Vector3>{jacobian} = normal_;
}

void HalfSpace::hessian(Index /*element*/, const double* /*x*/, const double* /*multipliers*/, Curvature /*curvature*/,
                        double* hessian) const {
  std::fill_n(hessian, 9, 0.0);
}

SphereObstacle::SphereObstacle(std::string name, std::string body, std::vector<int> vertices, int first_vertex,
                               double scene_size, double radius)
    : Obstacle(std::move(name), std::move(body), std::move(vertices), first_vertex, scene_size), radius_(radius) {}

void SphereObstacle::evaluate(Index /*element*/, const double* x, double* c, double* jacobian) const {
  const Vector3 offset = Eigen::Map<const Vector3>(x) - center_;
  const double distance = offset.norm();
  c[0] = distance - radius_;
  // At the very centre every direction leads out equally fast.
  if (jacobian) Eigen::Map<Vector3>{jacobian} = distance > 0 ? Vector3(offset / distance) : Vector3::UnitZ();
}

void SphereObstacle::hessian(Index /*element*/, const double* x, const double* multipliers, Curvature curvature,
                             double* hessian) const {
  const Vector3 offset = Eigen::Map<const Vector3>(x) - center_;
  const double distance = offset.norm();
  double weight = distance > 0 ? multipliers[0] / distance : 0.0;
  if (curvature == Curvature::positive_semidefinite) weight = std::max(weight, 0.0);
  const Vector3 n = distance > 0 ? Vector3(offset / distance) : Vector3::UnitZ();
  Eigen::Map<Matrix3>{hessian} = weight * (Matrix3::Identity() - n * n.transpose());
}

}  // namespace taut
