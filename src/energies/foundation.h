#pragma once

#include <string>
#include <vector>

#include "core/energy.h"

namespace taut {

/// Springs between the nodes of a fine membrane and the points of a coarse surface below them [Winkler]:
///   W_i = k a_i/2 |x_i - sum_j w_ij y_j|^2,
/// with a stiffness k per area (Pa/m) and the rest area a_i at a fine node. They act in every direction, which keeps
/// them independent of how the surface turns.
class WinklerFoundation final : public Energy {
 public:
  /// A fine node, the scene nodes that carry it with their weights, and its area in m^2.
  struct Spring {
    int node;
    std::vector<int> carriers;
    std::vector<double> weights;
    double area;
  };
  /// `stiffness` in Pa/m. Throws std::invalid_argument where springs differ in their number of carriers, or that is
  /// above 7.
  WinklerFoundation(std::string name, const std::vector<Spring>& springs, double stiffness);

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;

 private:
  std::string name_;
  int nodes_;  // to a spring
  Stencils stencils_;
  std::vector<double> weights_;    // 1, then minus those of the carriers, a spring
  std::vector<double> stiffness_;  // N/m, of each spring
};

}  // namespace taut
