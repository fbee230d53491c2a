#pragma once

#include <vector>

#include "core/types.h"
#include "linalg/elimination_subtrees.h"

struct cholmod_factor_struct;

namespace taut {

/// The numeric phase of a supernodal Cholesky factorisation on two threads, left-looking [Ng and Peyton 1993]. Each
/// thread factorises subtrees of the elimination tree of its own and sums what they owe to the columns above all
/// subtrees [Geist and Ng 1989]; those follow, with BLAS on both threads where blocks are large. The same bits each
/// time.
class SubtreeCholesky {
 public:
  /// `factor`, of CHOLMOD, has been analysed, has room for its values, and is borrowed. BLAS may use `threads` for
  /// large blocks above all subtrees.
  SubtreeCholesky(cholmod_factor_struct& factor, int threads);

  /// Puts L of matrix + shift I into CHOLMOD's factor; false where a pivot is not positive. A NaN may pass, and is then
  /// on the diagonal of L. Entries of `lower` above the diagonal are ignored.
  bool factorize(const SparseMatrix& lower, double shift);
  std::size_t memory_bytes() const;

 private:
  /// Scratch of one thread.
  struct Worker {
    std::vector<int> first;             // per supernode: the first of those whose next row is one of its columns, or -1
    std::vector<int> local_row;         // per row: its place in the block at work
    std::vector<double> update;         // dense, what one supernode owes to another
    std::vector<std::ptrdiff_t> place;  // per row of the update: that in the block
  };

  int columns(int supernode) const;
  int height(int supernode) const;
  const int* rows(int supernode) const;
  double* block(int supernode) const;
  void map_rows(int supernode, Worker& worker) const;
  void add_matrix(int supernode, const SparseMatrix& lower, double shift, const Worker& worker);
  void queue(int supernode, Worker& worker);
  void apply_descendants(int target, double* into, Worker& worker);
  void apply_descendant(int descendant, int target, double* into, Worker& worker);
  bool factorize_block(int supernode);
  bool factorize_share(int share, const SparseMatrix& lower, double shift);
  bool factorize_top();

  cholmod_factor_struct& factor_;
  int threads_;
  EliminationSubtrees division_;
  std::vector<int> supernode_;    // per column
  std::vector<int> next_;         // per supernode: that after it in a list of `first`
  std::vector<int> row_reached_;  // per supernode: the first of its rows that its updates have not reached
  std::vector<Worker> workers_;   // one per share; the first one's does the top, too
  std::vector<double> owed_;      // what the second share owes to the top: its blocks, one after the other
};

}  // namespace taut
