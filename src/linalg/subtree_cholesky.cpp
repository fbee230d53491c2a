#include "linalg/subtree_cholesky.h"

#include <cblas.h>
#include <cholmod.h>

#include <algorithm>
#include <utility>

#include "core/parallel.h"

extern "C" void openblas_set_num_threads(int);
extern "C" void dpotrf_(const char* triangle, const int* n, double* a, const int* stride, int* info);

namespace taut {
namespace {

/// Blocks of fewer columns have BLAS on one thread: two wait for each other at each call, and long where other programs
/// run.
constexpr int blas_threads_from = 256;

}  // namespace

SubtreeCholesky::SubtreeCholesky(cholmod_factor_struct& factor, int threads) : factor_(factor), threads_(threads) {
  const int supernodes = static_cast<int>(factor.nsuper);
  std::vector<double> flops;  // of a supernode's columns, updates included
  for (int s = 0; s < supernodes; ++s) {
    flops.push_back(0);
    for (int j = 0; j < columns(s); ++j) flops.back() += static_cast<double>(height(s) - j) * (height(s) - j);
    supernode_.insert(supernode_.end(), static_cast<std::size_t>(columns(s)), s);
  }
  division_ = elimination_subtrees(factor, flops);
  next_.resize(factor.nsuper);
  row_reached_.resize(factor.nsuper);
  workers_.resize(division_.shares.size());
  for (Worker& worker : workers_) {
    worker.first.resize(factor.nsuper);
    worker.local_row.resize(factor.n);
    worker.update.resize(factor.maxcsize);
    worker.place.resize(factor.maxesize);
  }
  std::size_t owed = 0;
  for (const int s : division_.top) owed += static_cast<std::size_t>(height(s)) * static_cast<std::size_t>(columns(s));
  if (workers_.size() > 1) owed_.resize(owed);
}

int SubtreeCholesky::columns(int supernode) const {
  const int* first_column = static_cast<const int*>(factor_.super);
  return first_column[supernode + 1] - first_column[supernode];
}

int SubtreeCholesky::height(int supernode) const {
  const int* row_start = static_cast<const int*>(factor_.pi);
  return row_start[supernode + 1] - row_start[supernode];
}

/// Ascending, its own columns first.
const int* SubtreeCholesky::rows(int supernode) const {
  return static_cast<const int*>(factor_.s) + static_cast<const int*>(factor_.pi)[supernode];
}

/// Dense, height x columns; what is above its diagonal means nothing.
double* SubtreeCholesky::block(int supernode) const {
  return static_cast<double*>(factor_.x) + static_cast<const int*>(factor_.px)[supernode];
}

void SubtreeCholesky::map_rows(int supernode, Worker& worker) const {
  const int *row = rows(supernode), count = height(supernode);
  for (int i = 0; i < count; ++i) worker.local_row[static_cast<std::size_t>(row[i])] = i;
}

/// Sets a supernode's block to its columns of matrix + shift I.
void SubtreeCholesky::add_matrix(int supernode, const SparseMatrix& lower, double shift, const Worker& worker) {
  const std::ptrdiff_t stride = height(supernode);
  const int begin = rows(supernode)[0], count = columns(supernode);
  double* column = block(supernode);
  std::fill(column, column + stride * count, 0.0);
  for (int j = 0; j < count; ++j, column += stride) {
    column[j] = shift;
    for (SparseMatrix::InnerIterator entry(lower, begin + j); entry; ++entry) {
      if (entry.row() >= begin + j) column[worker.local_row[static_cast<std::size_t>(entry.row())]] += entry.value();
    }
  }
}

/// Lists a supernode with that of the next of its rows, if there is one.
void SubtreeCholesky::queue(int supernode, Worker& worker) {
  const int reached = row_reached_[supernode];
  if (reached == height(supernode)) return;
  const int owner = supernode_[rows(supernode)[reached]];
  next_[supernode] = worker.first[owner];
  worker.first[owner] = supernode;
}

/// into -= what all supernodes that are listed with `target` owe to it.
void SubtreeCholesky::apply_descendants(int target, double* into, Worker& worker) {
  for (int descendant = std::exchange(worker.first[target], -1); descendant >= 0;) {
    const int following = next_[descendant];
    apply_descendant(descendant, target, into, worker);
    queue(descendant, worker);
    descendant = following;
  }
}

void SubtreeCholesky::apply_descendant(int descendant, int target, double* into, Worker& worker) {
  const int *row = rows(descendant), *first_column = static_cast<const int*>(factor_.super);
  const int stride = height(descendant), k = columns(descendant), begin = row_reached_[descendant];
  const int end = static_cast<int>(std::lower_bound(row + begin, row + stride, first_column[target + 1]) - row);
  const int n = end - begin, m = stride - begin;
  const double *own = block(descendant) + begin, *below = own + n;
  double* update = worker.update.data();
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, n, k, 1.0, own, stride, 0.0, update, m);
  if (m > n)
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasTrans, m - n, n, k, 1.0, below, stride, own, stride, 0.0, update + n,
                m);
  std::ptrdiff_t* place = worker.place.data();
  for (int i = 0; i < m; ++i) place[i] = worker.local_row[static_cast<std::size_t>(row[begin + i])];
  for (int j = 0; j < n; ++j, update += m) {
    double* column = into + place[j] * height(target);
    for (int i = j; i < m; ++i) column[place[i]] -= update[i];
  }
  row_reached_[descendant] = end;
}

/// L of a block to which all has been applied.
bool SubtreeCholesky::factorize_block(int supernode) {
  const int stride = height(supernode), n = columns(supernode);
  double* l = block(supernode);
  int info = 0;
  dpotrf_("L", &n, l, &stride, &info);
  if (info != 0) return false;
  if (stride > n)
    cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, stride - n, n, 1.0, l, stride, l + n,
                stride);
  row_reached_[supernode] = n;
  return true;
}

/// Factorises a share's subtrees. What they owe to the top the first share takes from the matrix there, the second from
/// zero.
bool SubtreeCholesky::factorize_share(int share, const SparseMatrix& lower, double shift) {
  Worker& worker = workers_[static_cast<std::size_t>(share)];
  std::fill(worker.first.begin(), worker.first.end(), -1);
  for (const Subtree& tree : division_.shares[static_cast<std::size_t>(share)]) {
    for (int s = tree.begin; s < tree.end; ++s) {
      map_rows(s, worker);
      add_matrix(s, lower, shift, worker);
      apply_descendants(s, block(s), worker);
      if (!factorize_block(s)) return false;
      queue(s, worker);
    }
  }
  if (share > 0) std::fill(owed_.begin(), owed_.end(), 0.0);
  double* owed = owed_.data();
  for (const int s : division_.top) {
    map_rows(s, worker);
    if (share == 0) {
      add_matrix(s, lower, shift, worker);
      apply_descendants(s, block(s), worker);
    } else {
      apply_descendants(s, owed, worker);
      owed += static_cast<std::ptrdiff_t>(height(s)) * columns(s);
    }
  }
  return true;
}

bool SubtreeCholesky::factorize_top() {
  Worker& worker = workers_.front();
  const double* owed = owed_.data();
  for (const int s : division_.top) {
    if (!owed_.empty()) {
      const std::ptrdiff_t size = static_cast<std::ptrdiff_t>(height(s)) * columns(s);
      Eigen::Map<Vector>(block(s), size) += Eigen::Map<const Vector>(owed, size);
      owed += size;
    }
    openblas_set_num_threads(columns(s) >= blas_threads_from ? threads_ : 1);
    map_rows(s, worker);
    apply_descendants(s, block(s), worker);
    if (!factorize_block(s)) return false;
    queue(s, worker);
  }
  return true;
}

bool SubtreeCholesky::factorize(const SparseMatrix& lower, double shift) {
  bool positive[2] = {true, true};
  openblas_set_num_threads(1);
  parallel_for(static_cast<int>(workers_.size()),
               [&](int share) { positive[share] = factorize_share(share, lower, shift); });
  return positive[0] && positive[1] && factorize_top();
}

std::size_t SubtreeCholesky::memory_bytes() const {
  const auto bytes = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  std::size_t sum = bytes(owed_) + bytes(supernode_) + bytes(next_) + bytes(row_reached_);
  for (const Worker& worker : workers_)
    sum += bytes(worker.first) + bytes(worker.local_row) + bytes(worker.update) + bytes(worker.place);
  return sum;
}

}  // namespace taut
