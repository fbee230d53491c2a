#include "linalg/single_precision_factor.h"

#include <cholmod.h>

#include <utility>

#include "core/parallel.h"

namespace taut {

SinglePrecisionFactor::SinglePrecisionFactor(const cholmod_factor_struct& factor, int threads)
    : factor_(factor), threads_(threads), supernodes_(static_cast<int>(factor.nsuper)) {
  std::vector<double> entries;
  for (int s = 0; s < supernodes_; ++s) {
    const double rows = row_start()[s + 1] - row_start()[s], columns = first_column()[s + 1] - first_column()[s];
    entries.push_back(rows * columns);
  }
  EliminationSubtrees division = elimination_subtrees(factor, entries);
  top_ = std::move(division.top);
  for (std::vector<Subtree>& subtrees : division.shares) shares_.push_back({std::move(subtrees), {}, {}});
  for (Share& share : shares_) {
    share.below.resize(static_cast<Index>(factor.maxesize));
    if (shares_.size() > 1) share.above.setZero(static_cast<Index>(factor.n));
  }
}

void SinglePrecisionFactor::round() {
  values_ =
      Eigen::Map<const Vector>(static_cast<const double*>(factor_.x), static_cast<Index>(factor_.xsize)).cast<float>();
}

const int* SinglePrecisionFactor::first_column() const { return static_cast<const int*>(factor_.super); }
const int* SinglePrecisionFactor::row_start() const { return static_cast<const int*>(factor_.pi); }

const int* SinglePrecisionFactor::rows_below(int supernode) const {
  const int columns = first_column()[supernode + 1] - first_column()[supernode];
  return static_cast<const int*>(factor_.s) + row_start()[supernode] + columns;
}

Eigen::Map<const Eigen::MatrixXf> SinglePrecisionFactor::block(int supernode) const {
  return {values_.data() + static_cast<const int*>(factor_.px)[supernode],
          row_start()[supernode + 1] - row_start()[supernode],
          first_column()[supernode + 1] - first_column()[supernode]};
}

/// Solves L y = b in place on some supernodes. What they take from columns at or after `end_column` is kept.
void SinglePrecisionFactor::forward(int begin, int end, int end_column, Share& share) {
  for (int s = begin; s < end; ++s) {
    const auto l = block(s);
    const Index columns = l.cols(), others = l.rows() - columns;
    auto own = solution_.segment(first_column()[s], columns);
    l.topRows(columns).triangularView<Eigen::Lower>().solveInPlace(own);
    share.below.head(others).noalias() = l.bottomRows(others) * own;
    const int* row = rows_below(s);
    Index i = 0;
    for (; i < others && row[i] < end_column; ++i) solution_[row[i]] -= share.below[i];
    for (; i < others; ++i) share.above[row[i]] += share.below[i];
  }
}

/// Solves L^T x = y in place on some supernodes, whose rows below are known.
void SinglePrecisionFactor::backward(int begin, int end, Share& share) {
  for (int s = end - 1; s >= begin; --s) {
    const auto l = block(s);
    const Index columns = l.cols(), others = l.rows() - columns;
    const int* row = rows_below(s);
    for (Index i = 0; i < others; ++i) share.below[i] = solution_[row[i]];
    auto own = solution_.segment(first_column()[s], columns);
    own.noalias() -= l.bottomRows(others).transpose() * share.below.head(others);
    l.topRows(columns).triangularView<Eigen::Lower>().transpose().solveInPlace(own);
  }
}

template <class Work>
void SinglePrecisionFactor::for_shares(const Work& work) {
  const int shares = static_cast<int>(shares_.size());
  const auto visit = [&](int k) {
    Share& share = shares_[static_cast<std::size_t>(k)];
    for (const Subtree& tree : share.subtrees) work(tree, share);
  };
  if (threads_ > 1) return parallel_for(shares, visit);
  for (int k = 0; k < shares; ++k) visit(k);
}

void SinglePrecisionFactor::solve(const Vector& b, Vector& x) {
  solution_ = b.cast<float>();
  const int columns = static_cast<int>(factor_.n);
  for_shares(
      [&](const Subtree& tree, Share& share) { forward(tree.begin, tree.end, first_column()[tree.end], share); });
  if (shares_.size() > 1) {
    for (const int s : top_) {
      const Index first = first_column()[s], size = first_column()[s + 1] - first;
      for (Share& share : shares_) {
        solution_.segment(first, size) -= share.above.segment(first, size);
        share.above.segment(first, size).setZero();
      }
    }
  }
  for (const int s : top_) forward(s, s + 1, columns, shares_.front());
  for (auto s = top_.rbegin(); s != top_.rend(); ++s) backward(*s, *s + 1, shares_.front());
  for_shares([&](const Subtree& tree, Share& share) { backward(tree.begin, tree.end, share); });
  x = solution_.cast<double>();
}

}  // namespace taut
