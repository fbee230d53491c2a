#pragma once

#include <string>
#include <vector>

#include "constraints/convex_sets.h"
#include "core/constraint.h"
#include "geometry/rest_shape.h"

namespace taut {

/// What both forms of the limit dmin <= d2 <= d1 <= dmax share: which triangles, and the violation max(d1 - dmax, dmin
/// - d2) in singular values.
struct StrainLimitTriangles {
  std::string constraint;               ///< its name in the problem file
  std::string body;                     ///< whose triangles these are
  std::vector<RestTriangle> triangles;  ///< the limited ones
  std::vector<int> ids;                 ///< their numbers within the body
  double min = 0;                       ///< 0: no lower limit
  double max = std::numeric_limits<double>::infinity();

  double violation(Index element, const double* x) const;
  std::string element_name(Index element) const;
};

/// The limit as one matrix constraint per triangle: dmin^2 I <= C <= dmax^2 I on C = F^T F, with one symmetric 2x2
/// multiplier in the rest frame; 2 Lambda is a rest-frame second Piola-Kirchhoff tension in N/m. Continuously
/// differentiable through d1 = d2. Rows are (C11, sqrt2 C12, C22); the weight is the rest area.
class MatrixStrainLimit final : public Constraint {
 public:
  explicit MatrixStrainLimit(StrainLimitTriangles limit);

  std::string name() const override { return limit_.constraint; }
  const Stencils& stencils() const override { return stencils_; }
  int rows() const override { return 3; }
  const ConvexSet& set() const override { return set_; }
  double weight(Index element) const override { return limit_.triangles[element].area; }
  void evaluate(Index element, const double* x, double* c, double* jacobian) const override;
  void hessian(Index element, const double* x, const double* multipliers, Curvature curvature,
               double* hessian) const override;
  bool takes_four() const override { return true; }
  void evaluate_four(Index quad, const Pack* x, Pack* c, Pack* jacobian) const override;
  void hessian_four(Index quad, const Pack* x, const Pack* multipliers, Curvature curvature,
                    Pack* hessian) const override;
  double violation(Index element, const double* x) const override { return limit_.violation(element, x); }
  std::string element_name(Index element) const override { return limit_.element_name(element); }
  /// Under a lower limit collapse is a stationary saddle of C: steps are kept from reaching it.
  bool guards_steps() const override { return limit_.min > 0; }
  double largest_step(Index element, const double* x, const double* dx) const override;
  const StrainLimitTriangles& limit() const { return limit_; }

 private:
  StrainLimitTriangles limit_;
  SpectralBox set_;
  Stencils stencils_{9};
  std::vector<RestQuad> quads_;
};

/// The limit with one multiplier per singular value, as in SL: rows (d1, d2), each in [dmin, dmax], gradients by SL
/// (27). The augmented Lagrangian of this form has a kink where d1 = d2 and the two multipliers differ (gradient jump
/// sqrt2 |lambda1 - lambda2|); the matrix form does not.
class SingularValueStrainLimit final : public Constraint {
 public:
  explicit SingularValueStrainLimit(StrainLimitTriangles limit);

  std::string name() const override { return limit_.constraint; }
  const Stencils& stencils() const override { return stencils_; }
  int rows() const override { return 2; }
  const ConvexSet& set() const override { return set_; }
  double weight(Index element) const override { return limit_.triangles[element].area; }
  void evaluate(Index element, const double* x, double* c, double* jacobian) const override;
  void hessian(Index element, const double* x, const double* multipliers, Curvature curvature,
               double* hessian) const override;
  double violation(Index element, const double* x) const override { return limit_.violation(element, x); }
  std::string element_name(Index element) const override { return limit_.element_name(element); }
  bool guards_steps() const override { return limit_.min > 0; }
  double largest_step(Index element, const double* x, const double* dx) const override;
  const StrainLimitTriangles& limit() const { return limit_; }

 private:
  StrainLimitTriangles limit_;
  Box set_;
  Stencils stencils_{9};
};

}  // namespace taut
