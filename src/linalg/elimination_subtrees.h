#pragma once

#include <vector>

struct cholmod_factor_struct;

namespace taut {

/// Supernodes begin ... end - 1 of a factor, which are a subtree of its elimination tree, and their work.
struct Subtree {
  int begin, end;
  double work;
};

/// A division of the elimination tree into subtrees, which do not touch each other, and what is above them all.
struct EliminationSubtrees {
  std::vector<std::vector<Subtree>> shares;  // of one thread each; two, or one without subtrees
  std::vector<int> top;                      // supernodes in no share, ascending
};

/// Divides the tree of a supernodal factor of CHOLMOD, by the work per supernode, for two threads: more would put more
/// columns above all subtrees. Where the columns are not in postorder, or where nothing would be gained, all is top.
EliminationSubtrees elimination_subtrees(const cholmod_factor_struct& factor, const std::vector<double>& work);

}  // namespace taut
