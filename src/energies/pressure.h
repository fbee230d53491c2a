#pragma once

#include <vector>

#include "core/energy.h"
#include "geometry/triangle_mesh.h"

namespace taut {

/// W(x) = -p V(x), V the sum of x0 . (x1 x x2)/6 over the triangles: the potential of a constant pressure p on the side
/// the normals leave, in Pa. It is one only for a closed surface, or where the whole boundary is fixed. The positive
/// semidefinite form is zero: the geometric stiffness of pressure has as many negative eigenvalues as positive ones.
class Pressure final : public Energy {
 public:
  Pressure(std::string name, const std::vector<Triangle>& triangles, double pressure);

  /// Multiplies the pressure; static load steps go from 0 to 1.
  void set_factor(double factor) { factor_ = factor; }

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;

 private:
  std::string name_;
  double pressure_;
  double factor_ = 1;
  Stencils stencils_{9};
};

}  // namespace taut
