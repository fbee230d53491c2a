#pragma once

#include <vector>

#include "core/energy.h"

namespace taut {

/// A moment on the directors of a shell's edge about a fixed axis: W(x) = -sum_k m_k phi_k(x), with phi_k the angle by
/// which director k, from the bottom to the top node, has turned about the axis since set_reference(). It has this
/// potential because the axis is fixed; the forces on the two nodes are a couple that follows the director.
///
/// Angles count from a reference direction and jump half a turn away from it; set_reference() moves it along, so a step
/// may turn an edge by less than half a turn.
class EndMoment final : public Energy {
 public:
  /// A bottom and a top node with the moment on them, N m.
  struct Load {
    int bottom, top;
    double moment;
  };
  /// `x`: all coordinates at rest, where the angles are zero, m. Throws std::invalid_argument where a director is along
  /// the axis or the axis has no length.
  EndMoment(std::string name, std::vector<Load> loads, const Vector3& axis, const Vector& x);

  /// Multiplies the moments; static load steps go from 0 to 1.
  void set_factor(double factor) { factor_ = factor; }
  /// Counts angles from here on, where the energy becomes zero; forces stay what they are.
  void set_reference(const Vector& x);

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;

 private:
  double turned(Index element, const Vector3& director) const;

  std::string name_;
  std::vector<Load> loads_;
  Vector3 axis_;
  std::vector<Vector3> reference_;  // where angles count from: unit vectors across the axis
  double factor_ = 1;
  Stencils stencils_{6};
};

}  // namespace taut
