#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/problem.h"

namespace taut {

/// Where the entries of a sparse matrix are; entries at the same place add up.
struct TripletPattern {
  std::vector<int> rows, columns;
};

/// A Problem as a classical smooth nonlinear program in its free variables y, the fixed ones substituted:
///   minimise f(y) subject to lower <= g(y) <= upper,
/// with g the smooth rows (ConvexSet::smooth_values) of each constraint's elements, one constraint after another, then
/// the linear equalities. Its
/// Lagrangian is f + nu . g, so that nu >= 0 where an upper bound is active and nu <= 0 at a lower one. Patterns are
/// computed once; values are written into the same places every time.
class NonlinearProgram {
 public:
  /// The energies and constraints of `problem` are borrowed. Throws what Problem::validate() throws.
  explicit NonlinearProgram(const Problem& problem);
  ~NonlinearProgram();

  /// True where `problem` is known (Problem::topology) to differ in its initial guess and fixed values only.
  bool fits(const Problem& problem) const;
  /// Takes the initial guess and the fixed values of a problem that fits.
  void update(const Problem& problem);

  Index variables() const;
  Index rows() const;
  const Vector& lower() const;  ///< of each row, -infinity where there is none
  const Vector& upper() const;  ///< of each row, +infinity where there is none
  const TripletPattern& jacobian_pattern() const;
  const TripletPattern& hessian_pattern() const;  ///< lower triangle

  /// The free variables of the initial guess.
  Vector start() const;
  /// All variables of the problem.
  Vector expand(const Vector& y) const;

  double objective(const Vector& y);
  /// Overwrites `gradient` and returns the objective.
  double gradient(const Vector& y, Vector& gradient);
  void constraints(const Vector& y, Vector& g) const;
  /// `values` as long as jacobian_pattern().
  void jacobian(const Vector& y, Vector& values) const;
  /// sigma f'' + sum_i nu_i g_i'', exact, as long as hessian_pattern().
  void hessian(const Vector& y, double sigma, const Vector& nu, Vector& values);

  /// The multipliers of the problem's own Lagrangian, lambda_e = (1/w_e) sum_i nu_i grad g_i(c_e).
  std::vector<Vector> multipliers(const Vector& y, const Vector& nu) const;
  /// The other way round, by least squares in each element; no multipliers at all give zeros.
  Vector row_multipliers(const Vector& y, const std::vector<Vector>& multipliers) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace taut
