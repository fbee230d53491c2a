#include "linalg/supernodal_ldlt.h"

#include <cblas.h>
#include <cholmod.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

extern "C" void openblas_set_num_threads(int);

namespace taut {
namespace {

constexpr double smallest_pivot = 1e-6;  // relative to its column
constexpr int unblocked_columns = 8;

/// `target` (m x n) = a - `left` (m x k) `right` (n x k)^T, with a = 0 or `target`.
void subtract_product(int m, int n, int k, const double* left, int left_stride, const double* right, int right_stride,
                      double a, double* target, int target_stride) {
  cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, m, n, k, -1.0, left, left_stride, right, right_stride, a, target,
              target_stride);
}

/// What CHOLMOD finds out about a pattern in its final order.
struct Supernodes {
  std::vector<int> starts;                   // first column of each, and the end of the last
  std::vector<int> row_starts, rows;         // of each, its own columns first
  std::vector<std::size_t> value_starts{0};  // of each, a dense block of its rows by its columns
  std::vector<int> of_column;
  double nonzeros = 0, flops = 0;

  int count() const { return static_cast<int>(starts.size()) - 1; }
  int width(int s) const { return starts[s + 1] - starts[s]; }
  int height(int s) const { return row_starts[s + 1] - row_starts[s]; }
  const int* rows_of(int s) const { return rows.data() + row_starts[s]; }
};

Supernodes find_supernodes(const SparseMatrix& lower) {
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_NATURAL;
  common.postorder = 0;
  common.supernodal = CHOLMOD_SUPERNODAL;
  cholmod_sparse sparse{};
  sparse.nrow = sparse.ncol = static_cast<std::size_t>(lower.rows());
  sparse.nzmax = static_cast<std::size_t>(lower.nonZeros());
  sparse.p = const_cast<int*>(lower.outerIndexPtr());
  sparse.i = const_cast<int*>(lower.innerIndexPtr());
  sparse.stype = -1;
  sparse.itype = CHOLMOD_INT;
  sparse.xtype = CHOLMOD_PATTERN;
  sparse.sorted = sparse.packed = 1;
  cholmod_factor* factor = cholmod_analyze(&sparse, &common);
  Supernodes all;
  const bool found = factor && factor->is_super;
  if (found) {
    const auto count = factor->nsuper;
    const auto copy = [](const void* from, std::size_t size) {
      return std::vector<int>(static_cast<const int*>(from), static_cast<const int*>(from) + size);
    };
    all.starts = copy(factor->super, count + 1);
    all.row_starts = copy(factor->pi, count + 1);
    all.rows = copy(factor->s, factor->ssize);
    all.flops = common.fl;
  }
  cholmod_free_factor(&factor, &common);
  cholmod_finish(&common);
  if (!found)
    throw std::runtime_error("CHOLMOD found no supernodes in a matrix of " + std::to_string(lower.rows()) + " rows");
  for (int s = 0; s < all.count(); ++s) {
    const auto width = static_cast<std::size_t>(all.width(s)), height = static_cast<std::size_t>(all.height(s));
    all.value_starts.push_back(all.value_starts.back() + width * height);
    all.nonzeros += static_cast<double>(width * height - width * (width - 1) / 2);
    all.of_column.insert(all.of_column.end(), width, s);
  }
  return all;
}

}  // namespace

struct SupernodalLdlt::Data {
  Supernodes supernodes;
  std::vector<int> order;
  std::vector<std::size_t> places;  // in `factor`, of each entry of the pattern
  std::vector<double> factor;       // block by block: unit lower L, entries on and above its diagonal to be ignored
  Vector pivots;
  mutable Vector solution, part;
  // Work of a factorisation.
  std::vector<double> update, scaled;
  std::vector<int> first, next, row_reached, local_row;

  bool factorize_columns(double* block, int stride, int height, int width, double* pivot);
  void scale(const double* rows, int stride, const double* pivot, int height, int width);
  void apply_descendant(int descendant, int target);
  void queue(int supernode);
};

bool SupernodalLdlt::available() {
#ifdef TAUT_WITH_SUPERNODAL
  return true;
#else
  return false;
#endif
}

SupernodalLdlt::SupernodalLdlt(Index size, const std::vector<int>& rows, const std::vector<int>& columns,
                               const std::vector<int>& order)
    : data_(std::make_unique<Data>()) {
  Data& d = *data_;
  d.order = order;
  d.pivots.resize(size);
  if (size == 0) return;
  std::vector<int> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
  std::vector<std::pair<int, int>> entries;  // row, column
  std::vector<Eigen::Triplet<double>> triplets;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    entries.push_back(std::minmax({place[rows[k]], place[columns[k]]}, std::greater<>()));
    triplets.emplace_back(entries.back().first, entries.back().second, 1.0);
  }
  SparseMatrix lower(size, size);
  lower.setFromTriplets(triplets.begin(), triplets.end());
  d.supernodes = find_supernodes(lower);
  const Supernodes& all = d.supernodes;
  for (const auto& [row, column] : entries) {
    const int s = all.of_column[column];
    const int* end = all.rows_of(s) + all.height(s);
    const auto local = static_cast<std::size_t>(std::lower_bound(all.rows_of(s), end, row) - all.rows_of(s));
    d.places.push_back(all.value_starts[s] +
                       static_cast<std::size_t>(column - all.starts[s]) * static_cast<std::size_t>(all.height(s)) +
                       local);
  }
  d.factor.resize(all.value_starts.back());
  d.next.resize(static_cast<std::size_t>(all.count()));
  d.row_reached.resize(static_cast<std::size_t>(all.count()));
  d.local_row.resize(static_cast<std::size_t>(size));
}

SupernodalLdlt::~SupernodalLdlt() = default;
SupernodalLdlt::SupernodalLdlt(SupernodalLdlt&&) noexcept = default;
SupernodalLdlt& SupernodalLdlt::operator=(SupernodalLdlt&&) noexcept = default;

/// scaled (height x width) = rows D.
void SupernodalLdlt::Data::scale(const double* rows, int stride, const double* pivot, int height, int width) {
  scaled.resize(static_cast<std::size_t>(height) * static_cast<std::size_t>(width));
  Eigen::Map<Matrix>(scaled.data(), height, width) =
      Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>(rows, height, width, Eigen::OuterStride<>(stride)) *
      Eigen::Map<const Vector>(pivot, width).asDiagonal();
}

/// L and D of a dense block with the diagonal in its first rows, one half of the columns after the other.
bool SupernodalLdlt::Data::factorize_columns(double* block, int stride, int height, int width, double* pivot) {
  if (width > unblocked_columns) {
    const int left = width / 2, right = width - left;
    if (!factorize_columns(block, stride, height, left, pivot)) return false;
    scale(block + left, stride, pivot, right, left);
    double* corner = block + static_cast<std::ptrdiff_t>(left) * stride + left;
    subtract_product(height - left, right, left, block + left, stride, scaled.data(), right, 1.0, corner, stride);
    return factorize_columns(corner, stride, height - left, right, pivot + left);
  }
  for (int j = 0; j < width; ++j) {
    double* diagonal = block + static_cast<std::ptrdiff_t>(j) * stride + j;
    Eigen::Map<Vector> below(diagonal + 1, height - j - 1);
    pivot[j] = *diagonal;
    const double largest = below.size() > 0 ? below.lpNorm<Eigen::Infinity>() : 0.0;
    if (!(std::abs(pivot[j]) >= smallest_pivot * largest) || pivot[j] == 0 || !std::isfinite(pivot[j])) return false;
    below /= pivot[j];
    for (int k = j + 1; k < width; ++k) {
      const double factor_of_row = pivot[j] * diagonal[k - j];
      Eigen::Map<Vector>(diagonal + static_cast<std::ptrdiff_t>(k - j) * stride + (k - j), height - k) -=
          factor_of_row * Eigen::Map<const Vector>(diagonal + (k - j), height - k);
    }
  }
  return true;
}

/// Subtracts from the block of `target` what a supernode has to do with the columns there that it has reached.
void SupernodalLdlt::Data::apply_descendant(int descendant, int target) {
  const int begin = row_reached[descendant], height = supernodes.height(descendant);
  const int width = supernodes.width(descendant), end_column = supernodes.starts[target + 1];
  const int* rows = supernodes.rows_of(descendant);
  const int end = static_cast<int>(std::lower_bound(rows + begin, rows + height, end_column) - rows);
  const double* block = factor.data() + supernodes.value_starts[descendant];
  const int columns = end - begin, below = height - begin;
  scale(block + begin, height, pivots.data() + supernodes.starts[descendant], columns, width);
  update.resize(static_cast<std::size_t>(below) * static_cast<std::size_t>(columns));
  subtract_product(below, columns, width, block + begin, height, scaled.data(), columns, 0.0, update.data(), below);
  double* into = factor.data() + supernodes.value_starts[target];
  const std::ptrdiff_t stride = supernodes.height(target);
  for (int j = 0; j < columns; ++j) {
    double* column = into + stride * (rows[begin + j] - supernodes.starts[target]);
    const double* change = update.data() + static_cast<std::ptrdiff_t>(j) * below;
    for (int i = j; i < below; ++i) column[local_row[rows[begin + i]]] += change[i];
  }
  row_reached[descendant] = end;
}

/// Lists a supernode with that of the next of its rows, if there is one.
void SupernodalLdlt::Data::queue(int supernode) {
  if (row_reached[supernode] == supernodes.height(supernode)) return;
  const int owner = supernodes.of_column[supernodes.rows_of(supernode)[row_reached[supernode]]];
  next[supernode] = first[owner];
  first[owner] = supernode;
}

bool SupernodalLdlt::factorize(const Vector& values) {
  Data& d = *data_;
  openblas_set_num_threads(1);
  std::fill(d.factor.begin(), d.factor.end(), 0.0);
  for (std::size_t k = 0; k < d.places.size(); ++k) d.factor[d.places[k]] += values[static_cast<Index>(k)];
  const Supernodes& all = d.supernodes;
  d.first.assign(d.next.size(), -1);
  for (int s = 0; s < static_cast<int>(d.next.size()); ++s) {
    const int *rows = all.rows_of(s), height = all.height(s);
    for (int i = 0; i < height; ++i) d.local_row[rows[i]] = i;
    for (int descendant = d.first[s]; descendant >= 0;) {
      const int following = d.next[descendant];
      d.apply_descendant(descendant, s);
      d.queue(descendant);
      descendant = following;
    }
    double* block = d.factor.data() + all.value_starts[s];
    if (!d.factorize_columns(block, height, height, all.width(s), d.pivots.data() + all.starts[s])) return false;
    d.row_reached[s] = all.width(s);
    d.queue(s);
  }
  return true;
}

Index SupernodalLdlt::negative_pivots() const { return (data_->pivots.array() < 0).count(); }

void SupernodalLdlt::solve(Vector& x) const {
  const Data& d = *data_;
  const Supernodes& all = d.supernodes;
  const int count = static_cast<int>(d.next.size());
  d.solution.resize(x.size());
  for (Index i = 0; i < x.size(); ++i) d.solution[i] = x[d.order[static_cast<std::size_t>(i)]];
  for (int s = 0; s < count; ++s) {
    const int width = all.width(s), height = all.height(s), below = height - width;
    const double* block = d.factor.data() + all.value_starts[s];
    double* own = d.solution.data() + all.starts[s];
    cblas_dtrsv(CblasColMajor, CblasLower, CblasNoTrans, CblasUnit, width, block, height, own, 1);
    d.part.resize(below);
    if (below > 0)
      cblas_dgemv(CblasColMajor, CblasNoTrans, below, width, 1.0, block + width, height, own, 1, 0.0, d.part.data(), 1);
    for (int i = 0; i < below; ++i) d.solution[all.rows_of(s)[width + i]] -= d.part[i];
  }
  d.solution.array() /= d.pivots.array();
  for (int s = count - 1; s >= 0; --s) {
    const int width = all.width(s), height = all.height(s), below = height - width;
    const double* block = d.factor.data() + all.value_starts[s];
    double* own = d.solution.data() + all.starts[s];
    d.part.resize(below);
    for (int i = 0; i < below; ++i) d.part[i] = d.solution[all.rows_of(s)[width + i]];
    if (below > 0)
      cblas_dgemv(CblasColMajor, CblasTrans, below, width, -1.0, block + width, height, d.part.data(), 1, 1.0, own, 1);
    cblas_dtrsv(CblasColMajor, CblasLower, CblasTrans, CblasUnit, width, block, height, own, 1);
  }
  for (Index i = 0; i < x.size(); ++i) x[d.order[static_cast<std::size_t>(i)]] = d.solution[i];
}

double SupernodalLdlt::factor_nonzeros() const { return data_->supernodes.nonzeros; }
double SupernodalLdlt::factor_flops() const { return data_->supernodes.flops; }

std::size_t SupernodalLdlt::memory_bytes() const {
  const Data& d = *data_;
  const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  return bytes(d.factor) + bytes(d.places) + bytes(d.supernodes.rows) + bytes(d.update) + bytes(d.scaled);
}

}  // namespace taut
