#pragma once

#include <limits>
#include <stdexcept>
#include <string>

#include "core/stencils.h"

namespace taut {

/// Which second derivative a caller wants: the true one, or one that is positive semidefinite in every element.
enum class Curvature { exact, positive_semidefinite };

/// f(x) = sum over elements e of W_e(x restricted to e's stencil), in joules when x is in metres.
/// A subclass writes its small local derivatives only; Assembly sums them in an order that does not depend on x.
class Energy {
 public:
  virtual ~Energy() = default;

  /// What a person calls it: "membrane of cloth".
  virtual std::string name() const = 0;
  virtual const Stencils& stencils() const = 0;

  /// The value W_e at the local variables x (width doubles). Where `gradient` (width doubles) or `hessian`
  /// (width x width, both triangles, column-major) is not null it is overwritten; a hessian is only asked with a
  /// gradient. A point outside the domain gives +infinity or NaN, never an exception.
  virtual double evaluate(Index element, const double* x, double* gradient, double* hessian,
                          Curvature curvature) const = 0;

  /// True where evaluate_four() serves for this curvature.
  virtual bool takes_four(Curvature /*curvature*/) const { return false; }
  /// evaluate() for a quad of elements at once (pack.h), lane by lane.
  virtual Pack evaluate_four(Index /*quad*/, const Pack* /*x*/, Pack* /*gradient*/, Pack* /*hessian*/,
                             Curvature /*curvature*/) const {
    throw std::logic_error(name() + " takes no four elements at once");
  }

  /// False for terms that are linear in x: they are left out of the Hessian's pattern.
  virtual bool has_curvature() const { return true; }

  /// True where what it couples beyond the other energies is usually weak beside them, as bending beside stretching and
  /// inertia: a factorisation may leave it to an iteration.
  virtual bool couples_weakly() const { return false; }

  /// The largest fraction of the step dx that keeps the element inside its domain (infinity where nothing guards it).
  virtual double largest_step(Index /*element*/, const double* /*x*/, const double* /*dx*/) const {
    return std::numeric_limits<double>::infinity();
  }
  /// True where largest_step() can be finite.
  virtual bool guards_steps() const { return false; }
};

}  // namespace taut
