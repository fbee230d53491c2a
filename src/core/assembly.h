#pragma once

#include <memory>
#include <vector>

#include "core/energy.h"

namespace taut {

/// Adjacency of groups of variables in compressed form: the neighbours of group g are neighbours[starts[g]] ... (itself
/// excluded, ascending).
struct GroupGraph {
  std::vector<int> starts, neighbours;
  int count() const { return static_cast<int>(starts.size()) - 1; }
};

/// Sums a list of energies over fixed sparsity: value, gradient, and Hessian on the variables that are not fixed.
///
/// Patterns, slots and the fill-reducing order are computed once. The Hessian is stored as the lower triangle of the
/// matrix in that order, in diagonal blocks stored fully (entries above the diagonal are for CHOLMOD to ignore). Every
/// thread owns a range of columns and of gradient entries and visits, in element order, all elements that touch it: the
/// bits do not depend on the number of threads.
///
/// Variables come in groups: vertices (three variables) where every stencil is made of them, single variables
/// otherwise. A group whose variables are all fixed leaves the matrix; one that is partly fixed keeps decoupled unit
/// rows for the fixed ones. Both are elimination by substitution.
class Assembly {
 public:
  /// `size` variables, `fixed` ascending indices of those that never move; the energies are borrowed.
  Assembly(Index size, const std::vector<const Energy*>& energies, const std::vector<int>& fixed, int threads);
  ~Assembly();
  Assembly(Assembly&&) noexcept;
  Assembly& operator=(Assembly&&) noexcept;

  /// Which free groups share an element of an energy with curvature.
  const GroupGraph& graph() const;
  /// The same without elements on which all energies couple weakly.
  GroupGraph strong_graph() const;
  /// Places node order[k] of graph() at position k, and computes pattern and slots anew. Until then the order is the
  /// natural one.
  void set_order(const std::vector<int>& order);
  /// Bytes in the pattern, values and slots.
  std::size_t memory_bytes() const;

  double value(const Vector& x) const;
  /// Overwrites `gradient` (size() entries; zero at fixed variables) and returns the value.
  double gradient(const Vector& x, Vector& gradient) const;
  /// Sets the entries of fixed variables to zero, as gradient() does.
  void clear_fixed(Vector& gradient) const;
  /// Recomputes the values of matrix() at x and, where `gradient` is not null, the gradient as gradient() does, in the
  /// same pass. With `hold_weak` energies that couple weakly add to the matrix what they did in the last call without.
  void hessian(const Vector& x, Curvature curvature, Vector* gradient = nullptr, bool hold_weak = false);
  const SparseMatrix& matrix() const;
  /// The largest fraction of dx that no guarded element objects to.
  double largest_step(const Vector& x, const Vector& dx) const;

  Index size() const;
  /// Variables in the matrix's order.
  Index ordered_size() const;
  void to_ordered(const Vector& full, Vector& ordered) const;
  /// Writes zero at fixed variables.
  void from_ordered(const Vector& ordered, Vector& full) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace taut
