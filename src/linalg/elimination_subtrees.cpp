#include "linalg/elimination_subtrees.h"

#include <cholmod.h>

#include <algorithm>
#include <numeric>

namespace taut {
namespace {

constexpr std::size_t most_shares = 2;

/// Of every supernode the first of its subtree, which in postorder reaches from there to itself; empty where the
/// columns are not in postorder.
std::vector<int> first_descendants(const cholmod_factor_struct& factor) {
  const int supernodes = static_cast<int>(factor.nsuper);
  const int *columns = static_cast<const int*>(factor.super), *row_start = static_cast<const int*>(factor.pi);
  std::vector<int> first(factor.nsuper), count(factor.nsuper, 1);
  std::iota(first.begin(), first.end(), 0);
  for (int s = 0; s < supernodes; ++s) {
    if (first[s] != s - count[s] + 1) return {};
    const int below = row_start[s] + columns[s + 1] - columns[s];
    if (below == row_start[s + 1]) continue;  // a root
    const int row = static_cast<const int*>(factor.s)[below];
    const auto parent = std::upper_bound(columns, columns + supernodes, row) - columns - 1;
    first[parent] = std::min(first[parent], first[s]);
    count[parent] += count[s];
  }
  return first;
}

double work_of(const std::vector<Subtree>& share) {
  return std::accumulate(share.begin(), share.end(), 0.0,
                         [](double sum, const Subtree& tree) { return sum + tree.work; });
}

/// Each in turn to who has the least work.
std::vector<std::vector<Subtree>> dealt(const std::vector<Subtree>& parts) {
  std::vector<std::vector<Subtree>> shares(most_shares);
  const auto lighter = [](const auto& a, const auto& b) { return work_of(a) < work_of(b); };
  for (const Subtree& part : parts) std::min_element(shares.begin(), shares.end(), lighter)->push_back(part);
  return shares;
}

}  // namespace

/// Takes the heaviest subtree apart, again and again, and keeps the division of which the columns above all subtrees
/// and the heaviest share together have the least work.
EliminationSubtrees elimination_subtrees(const cholmod_factor_struct& factor, const std::vector<double>& work) {
  const int supernodes = static_cast<int>(factor.nsuper);
  EliminationSubtrees best;
  best.shares.resize(1);
  best.top.resize(factor.nsuper);
  std::iota(best.top.begin(), best.top.end(), 0);
  const std::vector<int> first = first_descendants(factor);
  if (first.empty()) return best;

  std::vector<double> before(factor.nsuper + 1, 0.0);  // work of all supernodes before
  std::partial_sum(work.begin(), work.end(), before.begin() + 1);
  std::vector<Subtree> parts;
  const auto take_apart = [&](int begin, int end) {  // into the subtrees of which begin ... end - 1 consists
    for (int root = end - 1; root >= begin; root = first[root] - 1)
      parts.push_back({first[root], root + 1, before[root + 1] - before[first[root]]});
  };
  take_apart(0, supernodes);
  std::vector<int> top;
  double top_work = 0, least = before.back();
  while (!parts.empty() && parts.size() <= 8 * most_shares) {
    std::sort(parts.begin(), parts.end(), [](const Subtree& a, const Subtree& b) { return a.work > b.work; });
    std::vector<std::vector<Subtree>> shares = dealt(parts);
    double both = 0;
    for (const auto& share : shares) both = std::max(both, top_work + work_of(share));
    if (both < least) {
      least = both;
      best = {std::move(shares), top};
    }
    const Subtree heaviest = parts.front();
    parts.erase(parts.begin());
    top.push_back(heaviest.end - 1);
    top_work += work[heaviest.end - 1];
    take_apart(heaviest.begin, heaviest.end - 1);
  }
  std::sort(best.top.begin(), best.top.end());
  return best;
}

}  // namespace taut
