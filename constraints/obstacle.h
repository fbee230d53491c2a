#pragma once

#include <string>
#include <vector>

#include "constraints/convex_sets.h"
#include "core/constraint.h"

namespace taut {

/// What obstacles share: gap_i(x_i) >= 0 at chosen vertices, in m, with multipliers <= 0 that are contact forces in N.
class Obstacle : public Constraint {
 public:
  /// `vertices` are nodes of the scene, `first_vertex` what to subtract to name them within `body`; `scene_size` in m
  /// scales violations.
  Obstacle(std::string name, std::string body, std::vector<int> vertices, int first_vertex, double scene_size);

  std::string name() const final { return name_; }
  const Stencils& stencils() const final { return stencils_; }
  int rows() const final { return 1; }
  const ConvexSet& set() const final { return set_; }
  double violation(Index element, const double* x) const final;
  double violation_scale() const final { return scene_size_; }
  std::string element_name(Index element) const final;

 private:
  std::string name_, body_;
  std::vector<int> vertices_;
  int first_vertex_;
  double scene_size_;
  Box set_;
  Stencils stencils_{3};
};

/// n . (x - p) >= 0.
class HalfSpace final : public Obstacle {
 public:
  HalfSpace(std::string name, std::string body, std::vector<int> vertices, int first_vertex, double scene_size);
  /// Where it is now; `normal` points to the allowed side and need not have unit length.
  void place(const Vector3& point, const Vector3& normal);

  void evaluate(Index element, const double* x, double* c, double* jacobian) const override;
  void hessian(Index element, const double* x, const double* multipliers, Curvature curvature,
               double* hessian) const override;

 private:
  Vector3 point_ = Vector3::Zero(), normal_ = Vector3::UnitZ();
};

/// |x - center| - radius >= 0.
class SphereObstacle final : public Obstacle {
 public:
  SphereObstacle(std::string name, std::string body, std::vector<int> vertices, int first_vertex, double scene_size,
                 double radius);
  void place(const Vector3& center) { center_ = center; }
  const Vector3& center() const { return center_; }
  double radius() const { return radius_; }

  void evaluate(Index element, const double* x, double* c, double* jacobian) const override;
  void hessian(Index element, const double* x, const double* multipliers, Curvature curvature,
               double* hessian) const override;

 private:
  double radius_;
  Vector3 center_ = Vector3::Zero();
};

}  // namespace taut
