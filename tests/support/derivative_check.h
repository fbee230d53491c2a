#pragma once

#include <string>

#include "core/constraint.h"
#include "core/energy.h"

namespace taut {

/// What an energy promises about its positive semidefinite form.
enum class SemidefiniteForm {
  projection,  ///< nowhere below the exact one, and equal to it where that is positive semidefinite
  majorant,    ///< nowhere below the exact one
  other        ///< only positive semidefinite (Gauss-Newton, zero)
};

/// How a remainder falls with the step: the slope of log(remainder) over log(step), fitted where it is above round-off.
struct Decay {
  double slope = 0;
  bool vanishes = false;  ///< at round-off for all steps, as for terms of lower degree
  bool at_least(double wanted) const { return vanishes || slope > wanted; }
};

/// How one element's value, gradient and Hessian fit together at a point.
struct DerivativeReport {
  Decay first;             ///< of |f(x + t d) - f - t g.d|; 2 where g is right
  Decay second;            ///< of the same less t^2/2 d.H d; 3 where H is right
  Decay gradient;          ///< of |g(x + t d) - g - t H d|; 2 where H is right
  double asymmetry = 0;    ///< max |H - H^T| of both forms, relative to max |H|
  double lowest = 0;       ///< smallest eigenvalue of the semidefinite form over its largest entry
  double above_exact = 0;  ///< smallest eigenvalue of the semidefinite form minus the exact one, relative
  double from_exact = 0;   ///< max |semidefinite - exact|, relative
  bool exact_semidefinite = false;
};

/// Evaluates one element at the local variables `x` along random directions (the seed says which) and fits the slopes.
DerivativeReport check_derivatives(const Energy& energy, Index element, const Vector& x, unsigned seed);

/// Where the energy takes four elements at once, those are in value, gradient and Hessian what each alone is, to
/// round-off.
void expect_four_as_one(const Energy& energy, const Vector& x, const std::string& label);

/// GoogleTest expectations on check_derivatives() for every element of `energy` at x (all variables): slopes
/// above 1.9, 2.9 and 1.9, symmetry, what `form` says, and expect_four_as_one(). `label` tells a reader which case
/// failed.
void expect_derivatives(const Energy& energy, const Vector& x, SemidefiniteForm form, const std::string& label);

/// sum_i lambda_i c_i(x) of a constraint with fixed multipliers, as an energy: its derivatives are J^T lambda and
/// Constraint::hessian().
class Contraction final : public Energy {
 public:
  /// `constraint` is borrowed; `multipliers` has rows() entries an element.
  Contraction(const Constraint& constraint, Vector multipliers)
      : constraint_(constraint), multipliers_(std::move(multipliers)) {}

  std::string name() const override { return constraint_.name(); }
  const Stencils& stencils() const override { return constraint_.stencils(); }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;

 private:
  const Constraint& constraint_;
  Vector multipliers_;
};

}  // namespace taut
