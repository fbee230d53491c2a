#pragma once

#include <stdexcept>

#include "core/pack.h"
#include "core/types.h"

namespace taut {

/// A closed convex set K in R^m, one per element of a constraint: an interval, an orthant, or the 2x2 spectral box
/// lo I <= C <= hi I. Eliminating the slack of c(x) in K is the projection onto K; for an orthant that is max(-g -
/// lambda/mu, 0).
class ConvexSet {
 public:
  virtual ~ConvexSet() = default;
  virtual int dimension() const = 0;

  /// The nearest point of K to z (both `dimension()` doubles; Euclidean norm). Where `derivative` is not null it
  /// receives an element of the generalised derivative of the projection: symmetric, eigenvalues in [0, 1],
  /// column-major.
  virtual void project(Index element, const double* z, double* nearest, double* derivative) const = 0;

  /// True where all points within `radius` of z are in K. A set that cannot tell says no.
  virtual bool contains_ball(Index /*element*/, const double* /*z*/, double /*radius*/) const { return false; }

  /// The point that eliminating a slack with a logarithmic barrier gives: against one bound b it minimises |z - p|^2/2
  /// - epsilon log(b - p), which is p = z - (y + sqrt(y^2 + 4 epsilon))/2 with y = z - b; with two bounds both
  /// corrections are added. It lies inside K for every z and tends to project() as `epsilon` > 0 (the square of the
  /// smoothing width) tends to 0. `inverse` receives the inverse of its derivative in z (symmetric, eigenvalues between
  /// 1 and 1e8, where they are cut), `rate` the derivative of p in epsilon; both are required. [Chen and Harker 1993;
  /// Kanzow 1996; Smale 1987]
  virtual void project_smoothed(Index element, const double* z, double epsilon, double* nearest, double* inverse,
                                double* rate) const = 0;

  /// The same for a quad of elements at once (pack.h), lane by lane.
  virtual void project_smoothed_four(Index /*quad*/, const Pack* /*z*/, double /*epsilon*/, Pack* /*nearest*/,
                                     Pack* /*inverse*/, Pack* /*rate*/) const {
    throw std::logic_error("this set takes no four elements at once");
  }

  /// The same set as smooth scalar rows lower_i <= g_i(z) <= upper_i, for solvers that know nothing else. The rows may
  /// be as many as their implementer likes up to max_smooth_rows, and need a constraint qualification that the set
  /// itself does not; an implementation says where it fails.
  virtual int smooth_rows() const = 0;
  /// `smooth_rows()` doubles each, infinite where there is no bound.
  virtual void smooth_bounds(double* lower, double* upper) const = 0;
  /// g at z and, where not null, its Jacobian (smooth_rows() x dimension(), column-major).
  virtual void smooth_values(Index element, const double* z, double* g, double* jacobian) const = 0;
  /// sum_i weights[i] g_i''(z) (dimension() x dimension(), column-major, overwritten).
  virtual void smooth_hessian(Index element, const double* z, const double* weights, double* hessian) const = 0;
};

}  // namespace taut
