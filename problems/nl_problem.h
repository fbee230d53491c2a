#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "core/problem.h"
#include "core/result.h"
#include "core/solver.h"
#include "problems/nl_model.h"

namespace taut {

/// An NlModel as a Problem: the objective (negated where it is maximised) as an energy, each row and each bounded
/// variable as a constraint of its own, variables with equal bounds as fixed. Rows are scaled so that no derivative at
/// the start exceeds 100; violations are those of the model's own rows.
class NlProblem {
 public:
  /// Borrows the model. Throws InputError where a function has more than 4000 variables, where bounds cross, and
  /// where a row without variables does not hold.
  explicit NlProblem(const NlModel& model);
  ~NlProblem();

  const Problem& problem() const { return problem_; }
  /// The model's objective, sign and constant included.
  double objective(const Vector& x) const;
  /// The largest entry of the objective's gradient, but at least Problem::least_force_scale; 1 where there is none.
  double objective_force(const Vector& x) const;
  /// The variable that residuals call "vertex i".
  std::string name_of(const std::string& node) const;
  /// The rate of the objective in each row's bound, as AMPL reports it.
  Vector dual(const Result& result) const;
  /// The model's first guess at them as multipliers; empty where it has none.
  WarmStart warm() const;

 private:
  const NlModel& model_;
  std::vector<std::unique_ptr<Energy>> energies_;
  std::vector<std::unique_ptr<Constraint>> constraints_;
  std::vector<int> constraint_of_row_;  // -1: a row without bounds
  std::vector<double> row_scale_;
  Problem problem_;
};

}  // namespace taut
