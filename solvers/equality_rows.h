#pragma once

#include <vector>

#include "core/problem.h"

namespace taut {

/// All linear equalities of a problem as one system A x = b, in the order of Problem::equalities.
class EqualityRows {
 public:
  /// None.
  EqualityRows() : starts_{0} {}
  explicit EqualityRows(const Problem& problem);

  Index count() const { return rows_.rows(); }
  const SparseMatrix& rows() const { return rows_; }
  const Vector& values() const { return values_; }
  /// The values b of another problem with the same rows.
  void update(const Problem& problem);
  /// A x - b; zero where all of it is round-off of x.
  void violation(const Vector& x, Vector& violation) const;
  /// Adds A^T multipliers to `gradient`.
  void add_force(const Vector& multipliers, Vector& gradient) const;

  /// The multipliers that stand behind those of `constraints` constraints; zeros where the list is shorter or they do
  /// not fit.
  Vector stacked(const std::vector<Vector>& multipliers, std::size_t constraints) const;
  /// Writes them there, one vector per system.
  void put(const Vector& stacked, std::size_t constraints, std::vector<Vector>& multipliers) const;

 private:
  SparseMatrix rows_;
  Vector values_;
  std::vector<Index> starts_;  // of each system, and the end of the last
};

}  // namespace taut
