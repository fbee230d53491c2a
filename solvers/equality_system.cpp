#include "solvers/equality_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {
namespace {

constexpr int most_refinements = 8;

SparseMatrix ordered_rows(const Assembly& assembly, const EqualityRows& equalities, const std::vector<int>& fixed) {
  Vector variable;
  assembly.to_ordered(Vector::LinSpaced(assembly.size(), 0, static_cast<double>(assembly.size() - 1)), variable);
  std::vector<int> place(static_cast<std::size_t>(assembly.size()), -1);
  for (Index i = 0; i < variable.size(); ++i)
    place[static_cast<std::size_t>(std::lround(variable[i]))] = static_cast<int>(i);
  for (const int v : fixed) place[static_cast<std::size_t>(v)] = -1;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index column = 0; column < equalities.rows().outerSize(); ++column) {
    if (place[static_cast<std::size_t>(column)] < 0) continue;
    for (SparseMatrix::InnerIterator entry(equalities.rows(), column); entry; ++entry)
      entries.emplace_back(static_cast<int>(entry.row()), place[static_cast<std::size_t>(column)], entry.value());
  }
  SparseMatrix rows(equalities.count(), assembly.ordered_size());
  rows.setFromTriplets(entries.begin(), entries.end());
  return rows;
}

/// Nodes of `graph` and behind them one for each group of `group` rows, which touch the nodes of their columns.
GroupGraph with_rows(const GroupGraph& graph, const SparseMatrix& rows, int node_size, int group) {
  const int nodes = graph.count(), more = static_cast<int>(rows.rows()) / group;
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(nodes + more));
  for (int i = 0; i < nodes; ++i) {
    neighbours[i].assign(graph.neighbours.begin() + graph.starts[i], graph.neighbours.begin() + graph.starts[i + 1]);
  }
  for (Index column = 0; column < rows.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(rows, column); entry; ++entry) {
      const int row = nodes + static_cast<int>(entry.row()) / group, node = static_cast<int>(column) / node_size;
      neighbours[row].push_back(node);
      neighbours[node].push_back(row);
    }
  }
  GroupGraph all;
  all.starts.assign(1, 0);
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    all.neighbours.insert(all.neighbours.end(), list.begin(), list.end());
    all.starts.push_back(static_cast<int>(all.neighbours.size()));
  }
  return all;
}

/// Variables to a node of the assembly's graph.
int node_size_of(const Assembly& assembly) {
  return assembly.graph().count() == 0 ? 1 : static_cast<int>(assembly.ordered_size()) / assembly.graph().count();
}

}  // namespace

EqualitySystem::EqualitySystem(const Assembly& assembly, const EqualityRows& equalities, const std::vector<int>& fixed)
    : assembly_(assembly), rows_(ordered_rows(assembly, equalities, fixed)) {}

void EqualitySystem::find_penalties(double shift) {
  const Vector diagonal = assembly_.matrix().diagonal();
  Vector compliance = Vector::Zero(rows_.rows());
  for (Index column = 0; column < rows_.outerSize(); ++column) {
    const double stiffness = diagonal[column] + shift;
    if (!(stiffness > 0)) continue;
    for (SparseMatrix::InnerIterator entry(rows_, column); entry; ++entry)
      compliance[entry.row()] += entry.value() * entry.value() / stiffness;
  }
  const double largest = compliance.size() > 0 ? compliance.maxCoeff() : 0;
  penalties_.resize(rows_.rows());
  for (Index i = 0; i < penalties_.size(); ++i) {
    const double one = compliance[i] > 0 ? compliance[i] : largest > 0 ? largest : 1.0;
    penalties_[i] = 1e8 / one;
  }
}

bool EqualitySystem::factorize(double shift) {
  shift_ = shift;
  find_penalties(shift);
  return factorize_penalised(shift);
}

bool EqualitySystem::solve(const Vector& gradient, const Vector& violation, Vector& step, Vector& multiplier_step) {
  assembly_.to_ordered(gradient, ordered_);
  dx_.setZero(ordered_.size());
  dnu_.setZero(violation.size());
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < most_refinements; ++round) {
    part_ = -ordered_;
    part_nu_ = -violation;
    if (round > 0) {
      part_ -= assembly_.matrix().selfadjointView<Eigen::Lower>() * dx_ + shift_ * dx_ + rows_.transpose() * dnu_;
      part_nu_ -= rows_ * dx_;
      const double off = part_nu_.lpNorm<Eigen::Infinity>();
      // Round-off of the product, or no further progress.
      if (off <= 1e-15 * dx_.lpNorm<Eigen::Infinity>() || !(off < 0.5 * best)) break;
      best = off;
    }
    solve_penalised(part_, part_nu_);
    dx_ += part_;
    dnu_ += part_nu_;
  }
  assembly_.from_ordered(dx_, step);
  multiplier_step = dnu_;
  return true;
}

QuasiDefiniteSystem::QuasiDefiniteSystem(const Assembly& assembly, const EqualityRows& equalities,
                                         const std::vector<int>& fixed)
    : EqualitySystem(assembly, equalities, fixed) {
  const SparseMatrix& matrix = assembly.matrix();
  const Index n = matrix.rows(), m = rows().rows();
  for (Index column = 0; column < n; ++column) {
    for (Index slot = matrix.outerIndexPtr()[column]; slot < matrix.outerIndexPtr()[column + 1]; ++slot) {
      if (matrix.innerIndexPtr()[slot] < column) continue;
      if (matrix.innerIndexPtr()[slot] == column) diagonal_.push_back(static_cast<Index>(slots_.size()));
      slots_.push_back(slot);
      row_of_.push_back(matrix.innerIndexPtr()[slot]);
      column_of_.push_back(static_cast<int>(column));
    }
  }
  values_.resize(static_cast<Index>(slots_.size()) + rows().nonZeros() + m);
  for (Index column = 0; column < n; ++column) {
    for (SparseMatrix::InnerIterator entry(rows(), column); entry; ++entry) {
      row_of_.push_back(static_cast<int>(n + entry.row()));
      column_of_.push_back(static_cast<int>(column));
    }
  }
  for (Index i = 0; i < m; ++i) {
    row_of_.push_back(static_cast<int>(n + i));
    column_of_.push_back(static_cast<int>(n + i));
  }
  // Three rows of a coupled vertex have the same nodes.
  const int node_size = node_size_of(assembly), group = m % node_size == 0 ? node_size : 1;
  const std::vector<int> nodes = fill_reducing_order(with_rows(assembly.graph(), rows(), node_size, group));
  for (const int node : nodes) {
    const bool variable = node < assembly.graph().count();
    const int first = variable ? node * node_size : static_cast<int>(n) + (node - assembly.graph().count()) * group;
    for (int i = 0; i < (variable ? node_size : group); ++i) order_.push_back(first + i);
  }
  if (SupernodalLdlt::available()) factor_ = std::make_unique<SupernodalLdlt>(n + m, row_of_, column_of_, order_);
}

bool QuasiDefiniteSystem::factorize_values() {
  use_pivots_ = !factor_ || !factor_->factorize(values_);
  if (!use_pivots_) return true;
  ++pivoted_;
  if (!with_pivots_)
    with_pivots_ =
        std::make_unique<SymmetricIndefinite>(static_cast<Index>(order_.size()), row_of_, column_of_, order_);
  return with_pivots_->factorize(values_);
}

bool QuasiDefiniteSystem::factorize_penalised(double shift) {
  const double* values = assembly().matrix().valuePtr();
  for (std::size_t i = 0; i < slots_.size(); ++i) values_[static_cast<Index>(i)] = values[slots_[i]];
  for (const Index i : diagonal_) values_[i] += shift;
  // Rows scaled so that all of the matrix is about as large as H.
  const Vector& mu = penalties();
  const double stiffness = diagonal_.empty() ? 1 : values_(diagonal_).cwiseAbs().mean();
  scales_ = (1e-8 * stiffness * mu).cwiseSqrt();
  Index next = static_cast<Index>(slots_.size());
  for (Index column = 0; column < rows().outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(rows(), column); entry; ++entry)
      values_[next++] = scales_[entry.row()] * entry.value();
  }
  values_.tail(mu.size()) = -scales_.cwiseAbs2().cwiseQuotient(mu);
  negative_curvatures_.reset();
  if (!factorize_values()) return false;
  const Index negative = use_pivots_ ? with_pivots_->negative_pivots() : factor_->negative_pivots();
  negative_curvatures_ = negative - rows().rows();
  return negative_curvatures_ == 0;
}

void QuasiDefiniteSystem::solve_penalised(Vector& step, Vector& multipliers) {
  right_hand_side_.resize(step.size() + multipliers.size());
  right_hand_side_ << step, scales_.cwiseProduct(multipliers);
  use_pivots_ ? with_pivots_->solve(right_hand_side_) : factor_->solve(right_hand_side_);
  step = right_hand_side_.head(step.size());
  multipliers = scales_.cwiseProduct(right_hand_side_.tail(multipliers.size()));
}

NewtonSystem::Size QuasiDefiniteSystem::size() const {
  if (use_pivots_) return {with_pivots_->factor_flops(), with_pivots_->factor_nonzeros(), with_pivots_->memory_bytes()};
  if (!factor_) return {};
  return {factor_->factor_flops(), factor_->factor_nonzeros(), factor_->memory_bytes()};
}

namespace {

/// The rows without their variables' neighbours, as a graph on the nodes: all nodes of a row are neighbours.
GroupGraph filled(const GroupGraph& graph, const SparseMatrix& rows, int node_size) {
  const GroupGraph both = with_rows(graph, rows, node_size, 1);
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(graph.count()));
  for (int i = 0; i < graph.count(); ++i) {
    for (int k = both.starts[i]; k < both.starts[i + 1]; ++k) {
      const int other = both.neighbours[k];
      if (other < graph.count()) {
        neighbours[i].push_back(other);
        continue;
      }
      for (int l = both.starts[other]; l < both.starts[other + 1]; ++l) {
        if (both.neighbours[l] != i) neighbours[i].push_back(both.neighbours[l]);
      }
    }
    std::sort(neighbours[i].begin(), neighbours[i].end());
    neighbours[i].erase(std::unique(neighbours[i].begin(), neighbours[i].end()), neighbours[i].end());
  }
  GroupGraph result;
  result.starts.assign(1, 0);
  for (const auto& list : neighbours) {
    result.neighbours.insert(result.neighbours.end(), list.begin(), list.end());
    result.starts.push_back(static_cast<int>(result.neighbours.size()));
  }
  return result;
}

/// In place; returned so that it can stand before a base class.
Assembly& put_in_order(Assembly& assembly, const EqualityRows& equalities, const std::vector<int>& fixed) {
  const SparseMatrix rows = ordered_rows(assembly, equalities, fixed);
  assembly.set_order(fill_reducing_order(filled(assembly.graph(), rows, node_size_of(assembly))));
  return assembly;
}

}  // namespace

PenalisedRowsSystem::PenalisedRowsSystem(Assembly& assembly, const EqualityRows& equalities,
                                         const std::vector<int>& fixed, int threads)
    : EqualitySystem(put_in_order(assembly, equalities, fixed), equalities, fixed) {
  // With every entry of H and of A^T A, so that the pattern does not depend on their values.
  SparseMatrix pattern = assembly.matrix();
  pattern.coeffs().setOnes();
  SparseMatrix ones = rows();
  ones.coeffs().setOnes();
  sum_ = (pattern + SparseMatrix(ones.transpose() * ones)).triangularView<Eigen::Lower>();
  cholesky_ = std::make_unique<Cholesky>(sum_, threads);
}

bool PenalisedRowsSystem::factorize_penalised(double shift) {
  const SparseMatrix product = rows().transpose() * penalties().asDiagonal() * rows();
  SparseMatrix zeros = sum_;
  zeros.coeffs().setZero();
  sum_ = (zeros + assembly().matrix() + product).triangularView<Eigen::Lower>();
  return cholesky_->factorize(sum_, shift);
}

void PenalisedRowsSystem::solve_penalised(Vector& step, Vector& multipliers) {
  right_hand_side_ = step + rows().transpose() * penalties().cwiseProduct(multipliers);
  cholesky_->solve(right_hand_side_, step);
  multipliers = penalties().cwiseProduct(rows() * step - multipliers);
}

}  // namespace taut
