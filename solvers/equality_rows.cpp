#include "solvers/equality_rows.h"

#include <algorithm>

namespace taut {

EqualityRows::EqualityRows(const Problem& problem) : starts_{0} {
  std::vector<Eigen::Triplet<double>> entries;
  for (const LinearEqualities* equal : problem.equalities) {
    for (Index column = 0; column < equal->rows.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator entry(equal->rows, column); entry; ++entry) {
        entries.emplace_back(static_cast<int>(starts_.back() + entry.row()), static_cast<int>(column), entry.value());
      }
    }
    starts_.push_back(starts_.back() + equal->rows.rows());
  }
  rows_.resize(starts_.back(), problem.size());
  rows_.setFromTriplets(entries.begin(), entries.end());
  update(problem);
}

void EqualityRows::update(const Problem& problem) {
  values_.resize(count());
  for (std::size_t k = 0; k < problem.equalities.size(); ++k)
    values_.segment(starts_[k], starts_[k + 1] - starts_[k]) = problem.equalities[k]->values;
}

void EqualityRows::violation(const Vector& x, Vector& violation) const {
  if (count() == 0) return violation.resize(0);
  violation = rows_ * x - values_;
  if (violation.lpNorm<Eigen::Infinity>() <= 1e-14 * x.lpNorm<Eigen::Infinity>()) violation.setZero();
}

void EqualityRows::add_force(const Vector& multipliers, Vector& gradient) const {
  if (count() > 0) gradient += rows_.transpose() * multipliers;
}

Vector EqualityRows::stacked(const std::vector<Vector>& multipliers, std::size_t constraints) const {
  Vector all = Vector::Zero(count());
  for (std::size_t k = 0; k + 1 < starts_.size() && constraints + k < multipliers.size(); ++k) {
    const Index rows = starts_[k + 1] - starts_[k];
    if (multipliers[constraints + k].size() == rows) all.segment(starts_[k], rows) = multipliers[constraints + k];
  }
  return all;
}

void EqualityRows::put(const Vector& stacked, std::size_t constraints, std::vector<Vector>& multipliers) const {
  multipliers.resize(constraints + starts_.size() - 1);
  for (std::size_t k = 0; k + 1 < starts_.size(); ++k)
    multipliers[constraints + k] = stacked.segment(starts_[k], starts_[k + 1] - starts_[k]);
}

}  // namespace taut
