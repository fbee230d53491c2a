#pragma once

#include <vector>

#include "core/pack.h"
#include "core/parallel.h"
#include "solvers/eliminated_slack.h"

namespace taut {

/// The smoothed conditions F = lambda - lambda_s = 0, lambda_s = mu (y - P_s(y, epsilon)), y = c + lambda/mu, of all
/// elements. With D = dP_s/dy, Newton's equation towards epsilon + depsilon, D dlambda = mu (I - D) J dx - F - mu
/// dP_s/depsilon depsilon, eliminates dlambda = W J dx - r, W = mu (D^{-1} - I).
struct EliminatedSlack::Path {
  /// Some numbers of every element, a quad of elements (core/pack.h) after the other.
  class PerElement {
   public:
    PerElement(int numbers, Index elements)
        : numbers_(numbers), packs_(static_cast<std::size_t>(numbers) * static_cast<std::size_t>(quads(elements))) {}
    Pack* operator[](Index quad) { return packs_.data() + quad * Index{numbers_}; }
    const Pack* operator[](Index quad) const { return packs_.data() + quad * Index{numbers_}; }
    void put(Index element, const double* from) {
      for (int i = 0; i < numbers_; ++i)
        (*this)[element / Pack::size][i].lanes[static_cast<int>(element % Pack::size)] = from[i];
    }
    void get(Index element, double* to) const {
      for (int i = 0; i < numbers_; ++i)
        to[i] = (*this)[element / Pack::size][i][static_cast<int>(element % Pack::size)];
    }

   private:
    int numbers_;
    std::vector<Pack> packs_;
  };

  int rows, width;
  double epsilon = 0;
  PerElement smoothed;    // lambda_s
  PerElement mismatch;    // F
  PerElement rate;        // dP_s/depsilon
  PerElement jacobian;    // J, rows x width
  PerElement inverse;     // D^{-1}, rows x rows
  PerElement correction;  // r
  Vector square;          // |F|^2/mu^2

  Path(int r, int w, Index count)
      : rows(r),
        width(w),
        smoothed(r, count),
        mismatch(r, count),
        rate(r, count),
        jacobian(r * w, count),
        inverse(r * r, count),
        correction(r, count),
        square(count) {}

  /// task(first, last) for ranges of quads, each once.
  template <class Task>
  void for_ranges(int threads, const Task& task) const {
    const Index count = quads(square.size());
    parallel_for(threads, [&](int t) { task(count * t / threads, count * (t + 1) / threads); });
  }
};

}  // namespace taut
