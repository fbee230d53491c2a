#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/constraint.h"
#include "dynamics/modal/modal_basis.h"

namespace taut {

/// The set {0} in one dimension: an equality.
class Zero final : public ConvexSet {
 public:
  int dimension() const override { return 1; }
  void project(Index element, const double* z, double* nearest, double* derivative) const override;
  void project_smoothed(Index element, const double* z, double epsilon, double* nearest, double* inverse,
                        double* rate) const override;
  int smooth_rows() const override { return 1; }
  void smooth_bounds(double* lower, double* upper) const override;
  void smooth_values(Index element, const double* z, double* g, double* jacobian) const override;
  void smooth_hessian(Index element, const double* z, const double* weights, double* hessian) const override;
};

/// Coordinates of warped nodes that follow a script: E (rest + R~(Psi q) Phi q) - c = 0, an element each (MW (A.14)
/// with the exact Jacobian E (R~ Phi + (dR~/dw) Phi q Psi)). The multiplier is the force, in N, that the node puts on
/// its holder along the axis.
class WarpedPosition final : public Constraint {
 public:
  struct Held {
    int node, axis;
  };
  /// `first_node` is what to subtract from nothing: nodes are of the basis; `levels` names them within `body` as
  /// vertices. `size` in m scales violations.
  WarpedPosition(std::string name, std::string body, int levels, std::shared_ptr<const ModalBasis> basis,
                 std::vector<Held> held, double size);

  const std::vector<Held>& held() const { return held_; }
  /// One entry per element, m.
  void set_targets(Vector targets) { targets_ = std::move(targets); }
  const Vector& targets() const { return targets_; }
  /// Holds the rotations at those of q: the constraint is linear then.
  void freeze(const Vector& q);

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  int rows() const override { return 1; }
  const ConvexSet& set() const override { return zero_; }
  void evaluate(Index element, const double* q, double* c, double* jacobian) const override;
  void hessian(Index element, const double* q, const double* multipliers, Curvature curvature,
               double* hessian) const override;
  double violation(Index element, const double* q) const override;
  double violation_scale() const override { return size_; }
  std::string element_name(Index element) const override;

 private:
  using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, max_stencil_width>;
  Vector3 rotation(Index element, const Eigen::Map<const Vector>& q) const;

  std::string name_, body_;
  int levels_;
  std::shared_ptr<const ModalBasis> basis_;
  std::vector<Held> held_;
  std::vector<Rows> shapes_, rotations_;  // of each element's node
  double size_;
  Vector targets_, frozen_;  // frozen: rotation vectors, 3 an element; empty: none
  Zero zero_;
  Stencils stencils_;
};

}  // namespace taut
