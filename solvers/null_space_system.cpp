#include "solvers/null_space_system.h"

#include "linalg/conjugate_gradients.h"
#include "linalg/null_space.h"

namespace taut {
namespace {

/// One row for each fixed variable.
SparseMatrix pin_rows(const Problem& problem) {
  SparseMatrix rows(static_cast<Index>(problem.fixed_variables.size()), problem.size());
  for (std::size_t i = 0; i < problem.fixed_variables.size(); ++i) {
    rows.insert(static_cast<Index>(i), problem.fixed_variables[i]) = 1;
  }
  rows.makeCompressed();
  return rows;
}

/// Those of span(basis) that `rows` are zero on.
SparseMatrix narrowed(const SparseMatrix& basis, const SparseMatrix& rows) {
  return basis * null_space_basis(rows * basis);
}

SparseMatrix basis_of(const Problem& problem) {
  SparseMatrix basis(problem.size(), problem.size());
  basis.setIdentity();
  bool whole = true;
  for (const LinearEqualities* equal : problem.equalities) {
    basis = whole && equal->null_space.cols() > 0 ? equal->null_space : narrowed(basis, equal->rows);
    whole = false;
  }
  return problem.fixed_variables.empty() ? basis : narrowed(basis, pin_rows(problem));
}

SparseMatrix without_columns(const SparseMatrix& matrix, const std::vector<int>& columns) {
  SparseMatrix rest = matrix;
  for (const int column : columns) {
    for (SparseMatrix::InnerIterator entry(rest, column); entry; ++entry) entry.valueRef() = 0;
  }
  rest.prune([](Index, Index, double value) { return value != 0; });
  return rest;
}

}  // namespace

NullSpaceSystem::NullSpaceSystem(const Assembly& assembly, const EqualityRows& equalities, const Problem& problem,
                                 bool conjugate_gradients)
    : assembly_(assembly),
      fixed_(problem.fixed_variables),
      basis_(basis_of(problem)),
      rows_(without_columns(equalities.rows(), problem.fixed_variables)),
      conjugate_gradients_(conjugate_gradients) {
  if (rows_.rows() == 0) return;
  // The shift lets dependent rows be: their right-hand sides, where they are compatible, stay in the range.
  SparseMatrix product = rows_ * rows_.transpose();
  normal_.setShift(1e-14 * product.coeffs().abs().maxCoeff());
  normal_.compute(product);
}

bool NullSpaceSystem::factorize(double shift) {
  shift_ = shift;
  if (conjugate_gradients_) {
    preconditioner_ = basis_.cwiseAbs2().transpose() * Vector(assembly_.matrix().diagonal()).cwiseMax(0);
    preconditioner_.array() += shift;
    const double smallest = 1e-12 * preconditioner_.maxCoeff();
    preconditioner_ = preconditioner_.cwiseMax(smallest).cwiseInverse();
    return preconditioner_.allFinite();
  }
  const SparseMatrix full = assembly_.matrix().selfadjointView<Eigen::Lower>();
  reduced_ = basis_.transpose() * full * basis_;
  if (!analysed_) cholesky_.analyzePattern(reduced_);
  analysed_ = true;
  cholesky_.setShift(shift);
  cholesky_.factorize(reduced_);
  return cholesky_.info() == Eigen::Success;
}

bool NullSpaceSystem::solve(const Vector& gradient, const Vector& violation, Vector& step, Vector& multiplier_step) {
  const auto hessian = assembly_.matrix().selfadjointView<Eigen::Lower>();
  step.setZero(gradient.size());
  Vector force = gradient;
  if (!violation.isZero(0)) {
    step = -(rows_.transpose() * normal_.solve(violation));
    force += hessian * step;
  }
  const Vector along = basis_ * reduced_solution(basis_.transpose() * force);
  step -= along;
  for (const int variable : fixed_) step[variable] = 0;  // the basis has round-off there
  multiplier_step.resize(rows_.rows());
  if (rows_.rows() > 0) multiplier_step = -normal_.solve(rows_ * (force - hessian * along));
  return true;
}

Vector NullSpaceSystem::reduced_solution(const Vector& force) {
  if (conjugate_gradients_) return by_conjugate_gradients(force);
  return cholesky_.solve(force);
}

/// To 1e-4 of the right-hand side: Newton takes what is left in its next step, and steps cost less than half.
Vector NullSpaceSystem::by_conjugate_gradients(const Vector& right_hand_side) {
  const auto hessian = assembly_.matrix().selfadjointView<Eigen::Lower>();
  const auto apply = [&](const Vector& w, Vector& product) {
    const Vector moved = basis_ * w;
    product = basis_.transpose() * Vector(hessian * moved) + shift_ * w;
  };
  const auto precondition = [&](const Vector& residual, Vector& result) {
    result = preconditioner_.cwiseProduct(residual);
  };
  const double enough = 1e-8 * right_hand_side.dot(preconditioner_.cwiseProduct(right_hand_side));
  const auto done = [&](const Vector& residual) {
    return residual.dot(preconditioner_.cwiseProduct(residual)) <= enough;
  };
  Vector w;
  const CgEnd end = conjugate_gradients(right_hand_side, apply, precondition, done, 10 * right_hand_side.size(), w,
                                        effort_.iterations);
  if (end == CgEnd::negative_curvature && w.isZero(0)) precondition(right_hand_side, w);
  return w;
}

NewtonSystem::Size NullSpaceSystem::size() const {
  if (!analysed_) return {};
  const SparseMatrix& factor = cholesky_.matrixL().nestedExpression();
  double flops = 0;
  for (Index column = 0; column < factor.cols(); ++column) {
    const auto entries = static_cast<double>(factor.outerIndexPtr()[column + 1] - factor.outerIndexPtr()[column]);
    flops += entries * entries;
  }
  const auto nonzeros = static_cast<double>(factor.nonZeros());
  return {flops, nonzeros, static_cast<std::size_t>(factor.nonZeros()) * (sizeof(double) + sizeof(int))};
}

}  // namespace taut
