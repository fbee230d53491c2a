#include "solvers/preconditioned_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "linalg/conjugate_gradients.h"

namespace taut {
namespace {

/// About as dear as a factorisation of the whole matrix.
constexpr Index most_iterations = 20;
/// On finer meshes it takes more than those: bending grows beside inertia with the fourth power of the cells.
constexpr Index most_unknowns = 100000;

bool contains(const GroupGraph& graph, int group, int other) {
  const auto begin = graph.neighbours.begin();
  return std::binary_search(begin + graph.starts[group], begin + graph.starts[group + 1], other);
}

/// Adds to `product` what the columns of the groups begin ... end - 1 contribute to H v, H being the blocks of size B
/// on and below the diagonal of a symmetric matrix.
template <int B>
void add_product(const SparseMatrix& matrix, int begin, int end, const Vector& v, Vector& product) {
  const int *starts = matrix.outerIndexPtr(), *rows = matrix.innerIndexPtr();
  for (int group = begin; group < end; ++group) {
    const int start = starts[group * B], stride = starts[group * B + 1] - start;
    const double* values = matrix.valuePtr() + start;
    double in[B], out[B];
    for (int c = 0; c < B; ++c) {
      in[c] = v[group * B + c];
      out[c] = 0;
    }
    for (int k = 0; k < B; ++k)
      for (int c = 0; c < B; ++c) out[c] += values[k * stride + c] * in[k];
    for (int k = B; k < stride; ++k) {
      const int row = rows[start + k];
      const double other = v[row];
      double sum = 0;
      for (int c = 0; c < B; ++c) {
        sum += values[c * stride + k] * in[c];
        out[c] += values[c * stride + k] * other;
      }
      product[row] += sum;
    }
    for (int c = 0; c < B; ++c) product[group * B + c] += out[c];
  }
}

}  // namespace

PreconditionedSystem::PreconditionedSystem(const Assembly& assembly, const std::vector<int>& order, Cholesky& cholesky,
                                           int threads)
    : assembly_(assembly), cholesky_(cholesky), threads_(threads) {
  const GroupGraph strong = assembly.strong_graph();
  const SparseMatrix& matrix = assembly.matrix();
  const int n = static_cast<int>(matrix.rows()), group_size = group_size_ = n / strong.count();
  const int* starts = matrix.outerIndexPtr();
  middle_ = static_cast<int>(std::lower_bound(starts, starts + n, matrix.nonZeros() / 2) - starts) / group_size;
  const std::vector<int> own_order = fill_reducing_order(strong);
  std::vector<int> position(own_order.size());
  for (std::size_t p = 0; p < own_order.size(); ++p) position[own_order[p]] = static_cast<int>(p);
  for (int i = 0; i < n; ++i) place_.push_back(position[order[i / group_size]] * group_size + i % group_size);

  // Entries of the lower triangle, where H has them and where B does.
  std::vector<Eigen::Triplet<double>> entries;
  const auto in_b = [&](int row, int column) { return std::minmax(place_[row], place_[column]); };
  for (int column = 0; column < n; ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      const int row = static_cast<int>(entry.row());
      const int a = order[row / group_size], b = order[column / group_size];
      slots_.push_back(row < column ? ignored : a == b || contains(strong, a, b) ? 0 : weak);
      if (slots_.back() < 0) continue;
      const auto [low, high] = in_b(row, column);
      entries.emplace_back(high, low, 0.0);
    }
  }
  preconditioner_.resize(n, n);
  preconditioner_.setFromTriplets(entries.begin(), entries.end());
  const int *own_starts = preconditioner_.outerIndexPtr(), *rows = preconditioner_.innerIndexPtr();
  const auto slot = [&](int low, int high) {
    return static_cast<int>(std::lower_bound(rows + own_starts[low], rows + own_starts[low + 1], high) - rows);
  };
  std::size_t k = 0;
  for (int column = 0; column < n; ++column) {
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry, ++k) {
      if (slots_[k] < 0) continue;
      const auto [low, high] = in_b(static_cast<int>(entry.row()), column);
      slots_[k] = slot(low, high);
    }
  }
  for (const int place : place_) diagonal_.push_back(slot(place, place));
  factor_ = std::make_unique<Cholesky>(preconditioner_, threads);
}

bool PreconditionedSystem::pays(const Assembly& assembly) {
  return assembly.matrix().rows() <= most_unknowns &&
         assembly.strong_graph().neighbours.size() < assembly.graph().neighbours.size();
}

bool PreconditionedSystem::factorize(double shift) {
  const SparseMatrix& matrix = assembly_.matrix();
  shift_ = shift;
  direct_ = direct_only_ || allowed_ == 0;
  if (direct_) return factorize_whole();
  double* values = preconditioner_.valuePtr();
  std::fill(values, values + preconditioner_.nonZeros(), 0.0);
  const double* from = matrix.valuePtr();
  const int *starts = matrix.outerIndexPtr(), *rows = matrix.innerIndexPtr();
  for (int column = 0; column < matrix.cols(); ++column) {
    for (int k = starts[column]; k < starts[column + 1]; ++k) {
      const int slot = slots_[k];
      if (slot >= 0) {
        values[slot] += from[k];
      } else if (slot == weak) {
        values[diagonal_[rows[k]]] += std::abs(from[k]);
        values[diagonal_[column]] += std::abs(from[k]);
      }
    }
  }
  return factor_->factorize(preconditioner_, shift);
}

bool PreconditionedSystem::solve(const Vector& gradient, const Vector& /*violation*/, Vector& step,
                                 Vector& multiplier_step) {
  multiplier_step.resize(0);
  assembly_.to_ordered(gradient, right_hand_side_);
  if (!direct_) {
    const auto apply = [&](const Vector& v, Vector& product) { multiply(v, product); };
    const auto precondition = [&](const Vector& residual, Vector& result) {
      placed_.resize(residual.size());
      for (std::size_t i = 0; i < place_.size(); ++i) placed_[place_[i]] = residual[static_cast<Index>(i)];
      factor_->solve_roughly(placed_, placed_);
      result.resize(residual.size());
      for (std::size_t i = 0; i < place_.size(); ++i) result[static_cast<Index>(i)] = placed_[place_[i]];
    };
    const auto done = [&](const Vector& residual) { return residual.norm() <= allowed_; };
    const CgEnd end = conjugate_gradients(right_hand_side_, apply, precondition, done, most_iterations, solution_,
                                          effort_.iterations);
    direct_ = direct_only_ = end != CgEnd::converged;
    if (direct_) {
      ++effort_.refactorized;
      if (!factorize_whole()) return false;
    }
  }
  if (direct_) cholesky_.solve(right_hand_side_, solution_);
  assembly_.from_ordered(solution_, step);
  step = -step;
  return true;
}

/// product = (H + shift I) v, in two halves whatever the number of threads, for the same bits.
void PreconditionedSystem::multiply(const Vector& v, Vector& product) {
  product = shift_ * v;
  other_half_.setZero(v.size());
  const auto add_half = [&](int half) {
    const int begin = half == 0 ? 0 : middle_;
    const int end = half == 0 ? middle_ : static_cast<int>(v.size()) / group_size_;
    Vector& sum = half == 0 ? product : other_half_;
    if (group_size_ == 3) {
      add_product<3>(assembly_.matrix(), begin, end, v, sum);
    } else {
      add_product<1>(assembly_.matrix(), begin, end, v, sum);
    }
  };
  if (threads_ > 1) {
    parallel_for(2, add_half);
  } else {
    for (const int half : {0, 1}) add_half(half);
  }
  product += other_half_;
}

bool PreconditionedSystem::factorize_whole() {
  effort_.more_flops += cholesky_.factor_flops() - factor_->factor_flops();
  return cholesky_.factorize(assembly_.matrix(), shift_);
}

NewtonSystem::Size PreconditionedSystem::size() const {
  std::size_t bytes = factor_->memory_bytes() + cholesky_.memory_bytes();
  bytes += static_cast<std::size_t>(preconditioner_.nonZeros()) * (sizeof(double) + sizeof(int));
  bytes += (slots_.size() + diagonal_.size() + place_.size()) * sizeof(int);
  return {factor_->factor_flops(), factor_->factor_nonzeros(), bytes};
}

}  // namespace taut
