#include "core/assembly_pattern.h"

#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace taut {

AssemblyPattern::AssemblyPattern(Index variables, const std::vector<const Energy*>& energies,
                                 const std::vector<int>& fixed_variables, int thread_count)
    : size(variables), threads(thread_count) {
  if (threads < 1 || threads > 255)
    throw std::invalid_argument("Assembly: threads must be 1 to 255, got " + std::to_string(threads));
  fixed.assign(size, 0);
  for (int variable : fixed_variables) fixed.at(variable) = 1;
  for (const Energy* energy : energies) {
    auto same = std::find_if(terms.begin(), terms.end(), [&](const AssemblyTerm& term) { return term.takes(*energy); });
    if (same == terms.end()) same = terms.insert(same, AssemblyTerm{});
    same->energies.push_back(energy);
  }
  const auto strong =
      std::stable_partition(terms.begin(), terms.end(), [](const AssemblyTerm& term) { return term.couples_weakly(); });
  weak_terms = static_cast<std::size_t>(strong - terms.begin());
  choose_group_size();
  for (AssemblyTerm& term : terms) term.groups = term.stencils().width() / group_size;
  find_free_groups();
  graph = build_graph(true);
  std::vector<int> natural(free_groups.size());
  std::iota(natural.begin(), natural.end(), 0);
  set_order(natural);
}

void AssemblyPattern::choose_group_size() {
  group_size = size % 3 == 0 ? 3 : 1;
  for (const AssemblyTerm& term : terms) {
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

void AssemblyPattern::find_free_groups() {
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

GroupGraph AssemblyPattern::build_graph(bool with_weak) const {
  std::vector<std::vector<int>> neighbours(free_groups.size());
  for (const AssemblyTerm& term : terms) {
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
void AssemblyPattern::build_pattern() {
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

void AssemblyPattern::build_slots() {
  const int* starts = matrix.outerIndexPtr();
  const int* rows = matrix.innerIndexPtr();
  for (AssemblyTerm& term : terms) {
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
  for (int group : free_groups) {
    for (int i = 0; i < group_size; ++i) {
      if (!fixed[group * group_size + i]) continue;
      const int column = position[group] * group_size + i;
      unit_diagonal.push_back(starts[column] + i);
    }
  }
}

/// Splits the positions into ranges with about the same number of element visits, and lists the elements of each.
void AssemblyPattern::share_out() {
  const int count = graph.count();
  std::vector<double> work(count + 1, 0.0);
  for (const AssemblyTerm& term : terms) {
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
  for (AssemblyTerm& term : terms) {
    const Stencils& stencils = term.stencils();
    term.values.assign(stencils.count(), 0.0);
    term.primary.assign(stencils.count(), 0);
    term.elements.assign(threads, {});
    term.quads.assign(threads, {});
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
        if (!seen[t]) continue;
        const int quad = static_cast<int>(element) / Pack::size;
        term.elements[t].push_back(static_cast<int>(element));
        if (term.quads[t].empty() || term.quads[t].back() != quad) term.quads[t].push_back(quad);
      }
    }
  }
}

void AssemblyPattern::set_order(const std::vector<int>& groups) {
  if (groups.size() != free_groups.size()) {
    throw std::invalid_argument("Assembly::set_order: expected " + std::to_string(free_groups.size()) +
                                " groups, got " + std::to_string(groups.size()));
  }
  order.resize(groups.size());
  position.assign(compact.size(), -1);
  for (std::size_t p = 0; p < groups.size(); ++p) {
    order[p] = free_groups.at(groups[p]);
    if (position[order[p]] >= 0)
      throw std::invalid_argument("Assembly::set_order: group " + std::to_string(groups[p]) + " comes twice");
    position[order[p]] = static_cast<int>(p);
  }
  share_out();
  build_pattern();
  build_slots();
}

std::size_t AssemblyPattern::memory_bytes() const {
  std::size_t bytes = static_cast<std::size_t>(matrix.nonZeros()) * (sizeof(double) + sizeof(int));
  for (const AssemblyTerm& term : terms) {
    bytes += term.slots.size() * sizeof(BlockSlot) + term.values.size() * (sizeof(double) + 2);
    for (const auto* lists : {&term.elements, &term.quads}) {
      for (const auto& list : *lists) bytes += list.size() * sizeof(int);
    }
  }
  return bytes;
}

}  // namespace taut
