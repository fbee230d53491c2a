#include "core/assembly.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "core/parallel.h"
#include "core/scratch.h"

namespace taut {
namespace {

/// Where one block of an element's Hessian goes: rows `row`.. and columns `column`.. of the local matrix to
/// values[start + c * stride + r].
struct BlockSlot {
  int start = -1;  // -1: the block belongs to a fixed group
  int stride = 0;
  short row = 0, column = 0;
};

/// Energies on the same elements, whose local derivatives are summed before they are scattered, with what the assembly
/// knows about each element.
struct Term {
  std::vector<const Energy*> energies;     // all with curvature or all without
  int groups = 0;                          // per element
  std::vector<BlockSlot> slots;            // per element: groups (groups + 1) / 2, empty where there is no curvature
  std::vector<char> masked;                // per element: touches a partly fixed group
  std::vector<std::vector<int>> elements;  // per thread, with two or more threads
  std::vector<unsigned char> primary;      // per element: the one thread that writes its value
  mutable std::vector<double> values;      // per element

  const Stencils& stencils() const { return energies.front()->stencils(); }
  bool has_curvature() const { return energies.front()->has_curvature(); }
  bool couples_weakly() const {
    return std::all_of(energies.begin(), energies.end(), [](const Energy* energy) { return energy->couples_weakly(); });
  }
  bool takes(const Energy& energy) const {
    return has_curvature() == energy.has_curvature() && stencils() == energy.stencils();
  }
  /// As Energy::evaluate, of the sum.
  double evaluate(Index element, const double* x, double* gradient, double* hessian, Curvature curvature) const;
};

double Term::evaluate(Index element, const double* x, double* gradient, double* hessian, Curvature curvature) const {
  double value = energies.front()->evaluate(element, x, gradient, hessian, curvature);
  if (energies.size() == 1) return value;
  const int width = stencils().width();
  Scratch<max_stencil_width> more_gradient(width);
  Scratch<max_stencil_width * max_stencil_width> more_hessian(width * width);
  for (std::size_t k = 1; k < energies.size(); ++k) {
    value += energies[k]->evaluate(element, x, gradient ? more_gradient.data() : nullptr,
                                   hessian ? more_hessian.data() : nullptr, curvature);
    if (gradient) {
      for (int i = 0; i < width; ++i) gradient[i] += more_gradient[i];
    }
    if (hessian) {
      for (int i = 0; i < width * width; ++i) hessian[i] += more_hessian[i];
    }
  }
  return value;
}

/// Calls visit(element) for each element of the term that `thread` of `threads` has to see, in ascending order.
template <class Visit>
void for_elements(const Term& term, int thread, int threads, const Visit& visit) {
  if (threads == 1) {
    for (Index element = 0; element < term.stencils().count(); ++element) visit(element);
  } else {
    for (int element : term.elements[static_cast<std::size_t>(thread)]) visit(Index{element});
  }
}

}  // namespace

struct Assembly::Data {
  Index size = 0;
  int threads = 1;
  int group_size = 1;
  std::vector<Term> terms;
  std::vector<char> fixed;       // per variable
  std::vector<int> free_groups;  // group ids in the matrix, ascending
  std::vector<int> compact;      // group id -> index into free_groups, -1 where fully fixed
  GroupGraph graph;
  std::vector<int> position;       // group id -> position in the order, -1 where fully fixed
  std::vector<int> order;          // position -> group id
  std::vector<int> range;          // thread t owns positions range[t] ... range[t + 1] - 1
  std::vector<int> partly_fixed;   // group ids that keep unit rows
  std::vector<int> unit_diagonal;  // and where the ones of those rows go
  SparseMatrix matrix;

  void choose_group_size();
  void find_free_groups();
  GroupGraph build_graph(bool with_weak) const;
  void build_pattern();
  void build_slots();
  void share_out();
  int owner(int pos) const {
    return static_cast<int>(std::upper_bound(range.begin() + 1, range.end() - 1, pos) - range.begin()) - 1;
  }
  int group_of(const Stencils& stencils, Index element, int k) const {
    return stencils[element][k * group_size] / group_size;
  }

  double sum_of_values() const;
  void mask(const Term& term, Index element, double* hessian) const;
  template <int B>
  void add_hessian(int thread, const Vector& x, Curvature curvature, Vector* gradient);
  void add_local_gradient(const Term& term, Index element, int thread, const double* part, Vector& gradient) const;
  void clear_fixed(Vector& gradient) const;
};

void Assembly::Data::choose_group_size() {
  group_size = size % 3 == 0 ? 3 : 1;
  for (const Term& term : terms) {
    const Stencils& stencils = term.stencils();
    if (group_size == 3 && stencils.width() % 3 != 0) group_size = 1;
    for (Index element = 0; group_size == 3 && element < stencils.count(); ++element) {
      for (int i = 0; i < stencils.width(); i += 3) {
        const int* v = stencils[element] + i;
        if (v[0] % 3 != 0 || v[1] != v[0] + 1 || v[2] != v[0] + 2) group_size = 1;
      }
    }
  }
}

void Assembly::Data::find_free_groups() {
  const int groups = static_cast<int>(size) / group_size;
  compact.assign(groups, -1);
  for (int group = 0; group < groups; ++group) {
    bool free = false;
    for (int i = 0; i < group_size; ++i) free = free || !fixed[group * group_size + i];
    if (!free) continue;
    compact[group] = static_cast<int>(free_groups.size());
    free_groups.push_back(group);
  }
}

GroupGraph Assembly::Data::build_graph(bool with_weak) const {
  std::vector<std::vector<int>> neighbours(free_groups.size());
  for (const Term& term : terms) {
    if (!term.has_curvature() || (!with_weak && term.couples_weakly())) continue;
    const Stencils& stencils = term.stencils();
    for (Index element = 0; element < stencils.count(); ++element) {
      for (int a = 0; a < term.groups; ++a) {
        for (int b = 0; b < term.groups; ++b) {
          const int from = compact[group_of(stencils, element, a)], to = compact[group_of(stencils, element, b)];
          if (from >= 0 && to >= 0 && from != to) neighbours[from].push_back(to);
        }
      }
    }
  }
  GroupGraph built;
  built.starts.assign(1, 0);
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    built.neighbours.insert(built.neighbours.end(), list.begin(), list.end());
    built.starts.push_back(static_cast<int>(built.neighbours.size()));
  }
  return built;
}

/// The pattern: in each column of position p, the whole diagonal block, then the blocks of all later neighbours.
void Assembly::Data::build_pattern() {
  const int count = graph.count();
  Index nonzeros = 0;
  std::vector<std::vector<int>> later(count);
  for (int p = 0; p < count; ++p) {
    const int c = compact[order[p]];
    for (int k = graph.starts[c]; k < graph.starts[c + 1]; ++k) {
      const int q = position[free_groups[graph.neighbours[k]]];
      if (q > p) later[p].push_back(q);
    }
    std::sort(later[p].begin(), later[p].end());
    nonzeros += static_cast<Index>(group_size) * group_size * static_cast<Index>(later[p].size() + 1);
  }
  if (nonzeros > std::numeric_limits<int>::max()) throw std::length_error("Assembly: more than 2^31 nonzeros");
  const int n = count * group_size;
  matrix.resize(n, n);
  matrix.resizeNonZeros(nonzeros);
  int* starts = matrix.outerIndexPtr();
  int* rows = matrix.innerIndexPtr();
  int next = 0;
  for (int p = 0; p < count; ++p) {
    for (int c = 0; c < group_size; ++c) {
      starts[p * group_size + c] = next;
      for (int r = 0; r < group_size; ++r) rows[next++] = p * group_size + r;
      for (int q : later[p]) {
        for (int r = 0; r < group_size; ++r) rows[next++] = q * group_size + r;
      }
    }
  }
  starts[n] = next;
}

void Assembly::Data::build_slots() {
  const int* starts = matrix.outerIndexPtr();
  const int* rows = matrix.innerIndexPtr();
  for (Term& term : terms) {
    const Stencils& stencils = term.stencils();
    term.slots.clear();
    term.masked.assign(stencils.count(), 0);
    if (!term.has_curvature()) continue;
    for (Index element = 0; element < stencils.count(); ++element) {
      for (int i = 0; i < stencils.width(); ++i) term.masked[element] |= fixed[stencils[element][i]];
      for (int a = 0; a < term.groups; ++a) {
        for (int b = 0; b <= a; ++b) {
          BlockSlot slot;
          int p = position[group_of(stencils, element, a)], q = position[group_of(stencils, element, b)];
          slot.row = static_cast<short>(a * group_size);
          slot.column = static_cast<short>(b * group_size);
          if (p < q) {
            std::swap(p, q);
            std::swap(slot.row, slot.column);
          }
          if (q >= 0) {
            const int column = q * group_size;
            const int* found = std::lower_bound(rows + starts[column], rows + starts[column + 1], p * group_size);
            slot.start = static_cast<int>(found - rows);
            slot.stride = starts[column + 1] - starts[column];
          }
          term.slots.push_back(slot);
        }
      }
    }
  }
  unit_diagonal.clear();
  partly_fixed.clear();
  for (int group : free_groups) {
    for (int i = 0; i < group_size; ++i) {
      if (!fixed[group * group_size + i]) continue;
      if (partly_fixed.empty() || partly_fixed.back() != group) partly_fixed.push_back(group);
      const int column = position[group] * group_size + i;
      unit_diagonal.push_back(starts[column] + i);
    }
  }
}

/// Splits the positions into ranges with about the same number of element visits, and lists the elements of each.
void Assembly::Data::share_out() {
  const int count = graph.count();
  std::vector<double> work(count + 1, 0.0);
  for (const Term& term : terms) {
    const Stencils& stencils = term.stencils();
    for (Index element = 0; element < stencils.count(); ++element) {
      for (int k = 0; k < term.groups; ++k) {
        const int p = position[group_of(stencils, element, k)];
        if (p >= 0) work[p + 1] += stencils.width();
      }
    }
  }
  for (int p = 0; p < count; ++p) work[p + 1] += work[p];
  range.assign(threads + 1, count);
  range[0] = 0;
  for (int t = 1; t < threads; ++t) {
    range[t] = static_cast<int>(std::lower_bound(work.begin(), work.end(), work[count] * t / threads) - work.begin());
  }
  for (Term& term : terms) {
    const Stencils& stencils = term.stencils();
    term.values.assign(stencils.count(), 0.0);
    term.primary.assign(stencils.count(), 0);
    term.elements.assign(threads, {});
    if (threads == 1) continue;
    std::vector<char> seen(threads);
    for (Index element = 0; element < stencils.count(); ++element) {
      std::fill(seen.begin(), seen.end(), char{0});
      bool any = false;
      for (int k = 0; k < term.groups; ++k) {
        const int p = position[group_of(stencils, element, k)];
        if (p < 0) continue;
        if (!any) term.primary[element] = static_cast<unsigned char>(owner(p));
        seen[owner(p)] = 1;
        any = true;
      }
      if (!any) seen[0] = 1;
      for (int t = 0; t < threads; ++t) {
        if (seen[t]) term.elements[t].push_back(static_cast<int>(element));
      }
    }
  }
}

Assembly::Assembly(Index size, const std::vector<const Energy*>& energies, const std::vector<int>& fixed, int threads)
    : data_(std::make_unique<Data>()) {
  if (threads < 1 || threads > 255)
    throw std::invalid_argument("Assembly: threads must be 1 to 255, got " + std::to_string(threads));
  data_->size = size;
  data_->threads = threads;
  data_->fixed.assign(size, 0);
  for (int variable : fixed) data_->fixed.at(variable) = 1;
  for (const Energy* energy : energies) {
    auto& terms = data_->terms;
    auto same = std::find_if(terms.begin(), terms.end(), [&](const Term& term) { return term.takes(*energy); });
    if (same == terms.end()) same = terms.insert(same, Term{});
    same->energies.push_back(energy);
  }
  data_->choose_group_size();
  for (Term& term : data_->terms) term.groups = term.stencils().width() / data_->group_size;
  data_->find_free_groups();
  data_->graph = data_->build_graph(true);
  std::vector<int> natural(data_->free_groups.size());
  std::iota(natural.begin(), natural.end(), 0);
  set_order(natural);
}

Assembly::~Assembly() = default;
Assembly::Assembly(Assembly&&) noexcept = default;
Assembly& Assembly::operator=(Assembly&&) noexcept = default;

const GroupGraph& Assembly::graph() const { return data_->graph; }
GroupGraph Assembly::strong_graph() const { return data_->build_graph(false); }

void Assembly::set_order(const std::vector<int>& order) {
  Data& d = *data_;
  if (order.size() != d.free_groups.size()) {
    throw std::invalid_argument("Assembly::set_order: expected " + std::to_string(d.free_groups.size()) +
                                " groups, got " + std::to_string(order.size()));
  }
  d.order.resize(order.size());
  d.position.assign(d.compact.size(), -1);
  for (std::size_t p = 0; p < order.size(); ++p) {
    d.order[p] = d.free_groups.at(order[p]);
    if (d.position[d.order[p]] >= 0)
      throw std::invalid_argument("Assembly::set_order: group " + std::to_string(order[p]) + " comes twice");
    d.position[d.order[p]] = static_cast<int>(p);
  }
  d.share_out();
  d.build_pattern();
  d.build_slots();
}

std::size_t Assembly::memory_bytes() const {
  std::size_t bytes = static_cast<std::size_t>(data_->matrix.nonZeros()) * (sizeof(double) + sizeof(int));
  for (const Term& term : data_->terms) {
    bytes += term.slots.size() * sizeof(BlockSlot) + term.values.size() * (sizeof(double) + 2);
    for (const auto& list : term.elements) bytes += list.size() * sizeof(int);
  }
  return bytes;
}

double Assembly::Data::sum_of_values() const {
  double sum = 0;
  for (const Term& term : terms) sum += std::accumulate(term.values.begin(), term.values.end(), 0.0);
  return sum;
}

double Assembly::value(const Vector& x) const {
  const Data& d = *data_;
  parallel_for(d.threads, [&](int thread) {
    for (const Term& term : d.terms) {
      const Stencils& stencils = term.stencils();
      Scratch<max_stencil_width> local(stencils.width());
      const Index first = stencils.count() * thread / d.threads, last = stencils.count() * (thread + 1) / d.threads;
      for (Index element = first; element < last; ++element) {
        stencils.gather(element, x, local.data());
        term.values[element] = term.evaluate(element, local.data(), nullptr, nullptr, Curvature::exact);
      }
    }
  });
  return d.sum_of_values();
}

double Assembly::gradient(const Vector& x, Vector& gradient) const {
  const Data& d = *data_;
  gradient.setZero(d.size);
  parallel_for(d.threads, [&](int thread) {
    for (const Term& term : d.terms) {
      const Stencils& stencils = term.stencils();
      Scratch<max_stencil_width> local(stencils.width()), part(stencils.width());
      for_elements(term, thread, d.threads, [&](Index element) {
        stencils.gather(element, x, local.data());
        const double value = term.evaluate(element, local.data(), part.data(), nullptr, Curvature::exact);
        if (term.primary[element] == thread) term.values[element] = value;
        d.add_local_gradient(term, element, thread, part.data(), gradient);
      });
    }
  });
  d.clear_fixed(gradient);
  return d.sum_of_values();
}

/// Adds those entries of an element's gradient that `thread` owns.
void Assembly::Data::add_local_gradient(const Term& term, Index element, int thread, const double* part,
                                        Vector& gradient) const {
  const int* variables = term.stencils()[element];
  for (int k = 0; k < term.groups; ++k) {
    const int p = position[variables[k * group_size] / group_size];
    if (p < range[thread] || p >= range[thread + 1]) continue;
    for (int i = k * group_size; i < (k + 1) * group_size; ++i) gradient[variables[i]] += part[i];
  }
}

void Assembly::Data::clear_fixed(Vector& gradient) const {
  for (int group : partly_fixed) {
    for (int i = group * group_size; i < (group + 1) * group_size; ++i) {
      if (fixed[i]) gradient[i] = 0;
    }
  }
}

/// Clears the rows and columns of fixed variables in a local Hessian.
void Assembly::Data::mask(const Term& term, Index element, double* hessian) const {
  const Stencils& stencils = term.stencils();
  const int width = stencils.width();
  for (int i = 0; i < width; ++i) {
    if (!fixed[stencils[element][i]]) continue;
    for (int j = 0; j < width; ++j) hessian[i + j * width] = hessian[j + i * width] = 0;
  }
}

template <int B>
void Assembly::Data::add_hessian(int thread, const Vector& x, Curvature curvature, Vector* total) {
  double* values = matrix.valuePtr();
  const int first = matrix.outerIndexPtr()[range[thread] * B], last = matrix.outerIndexPtr()[range[thread + 1] * B];
  std::fill(values + first, values + last, 0.0);
  for (const Term& term : terms) {
    const bool curved = term.has_curvature();
    if (!curved && !total) continue;
    const Stencils& stencils = term.stencils();
    const int width = stencils.width(), blocks = term.groups * (term.groups + 1) / 2;
    Scratch<max_stencil_width> local(width), gradient(width);
    Scratch<max_stencil_width * max_stencil_width> hessian(width * width);
    for_elements(term, thread, threads, [&](Index element) {
      stencils.gather(element, x, local.data());
      term.evaluate(element, local.data(), gradient.data(), curved ? hessian.data() : nullptr, curvature);
      if (total) add_local_gradient(term, element, thread, gradient.data(), *total);
      if (!curved) return;
      if (term.masked[element]) mask(term, element, hessian.data());
      const BlockSlot* slot = term.slots.data() + element * blocks;
      for (int k = 0; k < blocks; ++k, ++slot) {
        if (slot->start < first || slot->start >= last) continue;
        for (int c = 0; c < B; ++c) {
          // Not the same memory, which the compiler cannot know and has to before it may add two rows at once.
          double* __restrict__ target = values + slot->start + c * slot->stride;
          const double* __restrict__ source = hessian.data() + (slot->column + c) * width + slot->row;
          for (int r = 0; r < B; ++r) target[r] += source[r];
        }
      }
    });
  }
}

void Assembly::clear_fixed(Vector& gradient) const {
  for (Index i = 0; i < gradient.size(); ++i) {
    if (data_->fixed[static_cast<std::size_t>(i)]) gradient[i] = 0;
  }
}

void Assembly::hessian(const Vector& x, Curvature curvature, Vector* gradient) {
  Data& d = *data_;
  if (gradient) gradient->setZero(d.size);
  parallel_for(d.threads, [&](int thread) {
    if (d.group_size == 3) {
      d.add_hessian<3>(thread, x, curvature, gradient);
    } else {
      d.add_hessian<1>(thread, x, curvature, gradient);
    }
  });
  for (int slot : d.unit_diagonal) d.matrix.valuePtr()[slot] = 1.0;
  if (gradient) d.clear_fixed(*gradient);
}

const SparseMatrix& Assembly::matrix() const { return data_->matrix; }

double Assembly::largest_step(const Vector& x, const Vector& dx) const {
  const Data& d = *data_;
  double largest = std::numeric_limits<double>::infinity();
  for (const Term& term : d.terms) {
    for (const Energy* energy : term.energies) {
      if (!energy->guards_steps()) continue;
      const Stencils& stencils = energy->stencils();
      Scratch<max_stencil_width> local(stencils.width()), step(stencils.width());
      for (Index element = 0; element < stencils.count(); ++element) {
        stencils.gather(element, x, local.data());
        stencils.gather(element, dx, step.data());
        largest = std::min(largest, energy->largest_step(element, local.data(), step.data()));
      }
    }
  }
  return largest;
}

Index Assembly::size() const { return data_->size; }
Index Assembly::ordered_size() const { return data_->matrix.rows(); }

void Assembly::to_ordered(const Vector& full, Vector& ordered) const {
  const Data& d = *data_;
  ordered.resize(ordered_size());
  for (std::size_t p = 0; p < d.order.size(); ++p) {
    for (int i = 0; i < d.group_size; ++i)
      ordered[static_cast<Index>(p) * d.group_size + i] = full[d.order[p] * d.group_size + i];
  }
}

void Assembly::from_ordered(const Vector& ordered, Vector& full) const {
  const Data& d = *data_;
  full.setZero(d.size);
  for (std::size_t p = 0; p < d.order.size(); ++p) {
    for (int i = 0; i < d.group_size; ++i) {
      const int variable = d.order[p] * d.group_size + i;
      if (!d.fixed[variable]) full[variable] = ordered[static_cast<Index>(p) * d.group_size + i];
    }
  }
}

}  // namespace taut
