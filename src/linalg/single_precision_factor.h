#pragma once

#include <vector>

#include "core/types.h"
#include "linalg/elimination_subtrees.h"

struct cholmod_factor_struct;

namespace taut {

/// Triangular solves with a copy of a supernodal factor in single precision, which halves the memory that they have to
/// read. Subtrees of the elimination tree do not touch each other, so that two threads can work on them; what they take
/// from the columns above them all is summed in the same order with one thread and with two.
class SinglePrecisionFactor {
 public:
  /// `factor`, of CHOLMOD, has been analysed and is borrowed. Where its columns are not in postorder one thread does
  /// all.
  SinglePrecisionFactor(const cholmod_factor_struct& factor, int threads);

  /// Copies the factor's values.
  void round();
  /// Solves L L^T x = b; `x` may be `b`.
  void solve(const Vector& b, Vector& x);
  std::size_t memory_bytes() const { return static_cast<std::size_t>(values_.size()) * sizeof(float); }

 private:
  /// Subtrees that one thread sees to, with its scratch.
  struct Share {
    std::vector<Subtree> subtrees;
    Eigen::VectorXf below;  // the rows of one supernode that are not its own columns
    Eigen::VectorXf above;  // per column: what the subtrees take from it, where it is in none
  };

  const int* first_column() const;
  const int* row_start() const;
  /// Rows of a supernode that are not its own columns, ascending.
  const int* rows_below(int supernode) const;
  Eigen::Map<const Eigen::MatrixXf> block(int supernode) const;
  template <class Work>
  void for_shares(const Work& work);
  void forward(int begin, int end, int end_column, Share& share);
  void backward(int begin, int end, Share& share);

  const cholmod_factor_struct& factor_;
  int threads_, supernodes_;
  std::vector<Share> shares_;
  std::vector<int> top_;  // supernodes in no share, ascending
  Eigen::VectorXf values_, solution_;
};

}  // namespace taut
