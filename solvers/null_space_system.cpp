#include "solvers/null_space_system.h"

#include "linalg/null_space.h"

namespace taut {
namespace {

/// One row for each fixed variable.
SparseMatrix equality_rows(const Problem& problem) {
  SparseMatrix rows(static_cast<Index>(problem.fixed_variables.size()), problem.size());
  for (std::size_t i = 0; i < problem.fixed_variables.size(); ++i) {
    rows.insert(static_cast<Index>(i), problem.fixed_variables[i]) = 1;
  }
  rows.makeCompressed();
  return rows;
}

}  // namespace

NullSpaceSystem::NullSpaceSystem(const Assembly& assembly, const Problem& problem)
    : assembly_(assembly), basis_(null_space_basis(equality_rows(problem))) {}

bool NullSpaceSystem::factorize(double shift) {
  const SparseMatrix full = assembly_.matrix().selfadjointView<Eigen::Lower>();
  reduced_ = basis_.transpose() * full * basis_;
  if (!analysed_) cholesky_.analyzePattern(reduced_);
  analysed_ = true;
  cholesky_.setShift(shift);
  cholesky_.factorize(reduced_);
  return cholesky_.info() == Eigen::Success;
}

void NullSpaceSystem::solve(const Vector& gradient, Vector& step) {
  step = -(basis_ * cholesky_.solve(basis_.transpose() * gradient));
}

}  // namespace taut
