#pragma once

#include <algorithm>
#include <vector>

#include "core/assembly.h"

namespace taut {

/// Where one block of an element's Hessian goes: rows `row`.. and columns `column`.. of the local matrix to
/// values[start + c * stride + r].
struct BlockSlot {
  int start = -1;  // -1: the block belongs to a fixed group
  int stride = 0;
  short row = 0, column = 0;
};

/// Energies on the same elements, whose local derivatives are summed before they are scattered, with what the assembly
/// knows about each element.
struct AssemblyTerm {
  std::vector<const Energy*> energies;     // all with curvature or all without
  int groups = 0;                          // per element
  std::vector<BlockSlot> slots;            // per element: groups (groups + 1) / 2, empty where there is no curvature
  std::vector<char> masked;                // per element: touches a partly fixed group
  std::vector<std::vector<int>> elements;  // per thread, with two or more threads
  std::vector<std::vector<int>> quads;     // the same in quads of elements
  std::vector<unsigned char> primary;      // per element: the one thread that writes its value
  mutable std::vector<double> values;      // per element

  const Stencils& stencils() const { return energies.front()->stencils(); }
  bool has_curvature() const { return energies.front()->has_curvature(); }
  bool couples_weakly() const {
    return std::all_of(energies.begin(), energies.end(), [](const Energy* energy) { return energy->couples_weakly(); });
  }
  bool takes_four(Curvature curvature) const {
    return std::all_of(energies.begin(), energies.end(),
                       [&](const Energy* energy) { return energy->takes_four(curvature); });
  }
  bool takes(const Energy& energy) const {
    return has_curvature() == energy.has_curvature() && stencils() == energy.stencils();
  }
};

/// What an Assembly knows before any sum: its terms, the order of its unknowns, the pattern of its matrix, where each
/// element's entries go in it, and which thread sees to which.
struct AssemblyPattern {
  Index size = 0;
  int threads = 1;
  int group_size = 1;
  std::vector<AssemblyTerm> terms;  // those that couple weakly first
  std::size_t weak_terms = 0;       // how many that are
  std::vector<char> fixed;          // per variable
  std::vector<int> free_groups;     // group ids in the matrix, ascending
  std::vector<int> compact;         // group id -> index into free_groups, -1 where fully fixed
  GroupGraph graph;
  std::vector<int> position;       // group id -> position in the order, -1 where fully fixed
  std::vector<int> order;          // position -> group id
  std::vector<int> range;          // thread t owns positions range[t] ... range[t + 1] - 1
  std::vector<int> unit_diagonal;  // where the ones of fixed variables' rows go, in groups not fixed as a whole
  SparseMatrix matrix;

  /// As Assembly's constructor; in the natural order.
  AssemblyPattern(Index size, const std::vector<const Energy*>& energies, const std::vector<int>& fixed, int threads);
  /// As Assembly::set_order.
  void set_order(const std::vector<int>& groups);
  GroupGraph build_graph(bool with_weak) const;
  std::size_t memory_bytes() const;
  int owner(int pos) const {
    return static_cast<int>(std::upper_bound(range.begin() + 1, range.end() - 1, pos) - range.begin()) - 1;
  }
  int group_of(const Stencils& stencils, Index element, int k) const {
    return stencils[element][k * group_size] / group_size;
  }

 private:
  void choose_group_size();
  void find_free_groups();
  void build_pattern();
  void build_slots();
  void share_out();
};

}  // namespace taut
