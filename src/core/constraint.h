#pragma once

#include <limits>
#include <string>

#include "core/convex_set.h"
#include "core/energy.h"

namespace taut {

/// c(x) in K, made of elements with `rows()` rows and few variables each. The Lagrangian is L = f + sum_e w_e lambda_e
/// . c_e(x), with the weight w_e an area where the multiplier is a density (strain limits: N/m) and 1 where it is a
/// force (obstacles: N).
class Constraint {
 public:
  virtual ~Constraint() = default;

  /// The name a person gave it in the problem file.
  virtual std::string name() const = 0;
  virtual const Stencils& stencils() const = 0;
  virtual int rows() const = 0;
  virtual const ConvexSet& set() const = 0;
  virtual double weight(Index /*element*/) const { return 1.0; }

  /// c_e at the local variables x (`rows()` doubles) and, where not null, its Jacobian (rows x width, column-major).
  virtual void evaluate(Index element, const double* x, double* c, double* jacobian) const = 0;
  /// sum_i multipliers[i] c_i''(x) (width x width, column-major, overwritten), exact or made positive semidefinite.
  virtual void hessian(Index element, const double* x, const double* multipliers, Curvature curvature,
                       double* hessian) const = 0;

  /// True where evaluate_four() and hessian_four() serve, and its set's project_smoothed_four().
  virtual bool takes_four() const { return false; }
  /// evaluate() and hessian() for a quad of elements at once (pack.h), lane by lane; c and jacobian are both required.
  virtual void evaluate_four(Index /*quad*/, const Pack* /*x*/, Pack* /*c*/, Pack* /*jacobian*/) const {
    throw std::logic_error(name() + " takes no four elements at once");
  }
  virtual void hessian_four(Index /*quad*/, const Pack* /*x*/, const Pack* /*multipliers*/, Curvature /*curvature*/,
                            Pack* /*hessian*/) const {
    throw std::logic_error(name() + " takes no four elements at once");
  }

  /// How far the element is outside, in the units a person thinks in (singular values, metres); 0 inside.
  virtual double violation(Index element, const double* x) const = 0;
  /// What a violation of "one" means: 1 for singular values, the scene's size for lengths.
  virtual double violation_scale() const { return 1.0; }
  /// "triangle 17 of cloth".
  virtual std::string element_name(Index element) const = 0;

  /// As in Energy.
  virtual double largest_step(Index /*element*/, const double* /*x*/, const double* /*dx*/) const {
    return std::numeric_limits<double>::infinity();
  }
  virtual bool guards_steps() const { return false; }
};

}  // namespace taut
