#pragma once

#include <span>
#include <vector>

#include "core/pack.h"
#include "core/types.h"

namespace taut {

/// Which variables each element of a sum touches: `count()` elements of `width()` variables each. Fixed for life.
class Stencils {
 public:
  explicit Stencils(int width) : width_(width) {}

  /// Appends an element; `variables` has width() entries, indices into the vector of unknowns.
  void add(std::span<const int> variables);
  /// Appends an element whose variables are the three coordinates of each of these vertices, in order (width = 3 x
  /// vertices).
  void add_vertices(std::span<const int> vertices);

  bool operator==(const Stencils&) const = default;

  int width() const { return width_; }
  Index count() const { return count_; }
  const int* operator[](Index element) const { return variables_.data() + element * width_; }

  /// Copies the entries of x that `element` touches to `local` (width() doubles).
  void gather(Index element, const Vector& x, double* local) const {
    const int* variables = (*this)[element];
    for (int i = 0; i < width_; ++i) local[i] = x[variables[i]];
  }
  /// The same for a quad of elements (pack.h).
  void gather(Index quad, const Vector& x, Pack* local) const {
    const int* variables[Pack::size];
    for (int lane = 0; lane < Pack::size; ++lane) variables[lane] = (*this)[element_of(quad, lane, count())];
    for (int i = 0; i < width_; ++i) local[i] = lanes_of([&](int lane) { return x[variables[lane][i]]; });
  }

 private:
  int width_;
  Index count_ = 0;
  std::vector<int> variables_;
};

/// Elements with more variables need allocations (scratch.h); no scene has any, warped modes need one variable each.
inline constexpr int max_stencil_width = 64;
/// No constraint has more rows per element than this.
inline constexpr int max_rows = 6;
/// No convex set has more smooth scalar rows (ConvexSet::smooth_rows).
inline constexpr int max_smooth_rows = 6;

}  // namespace taut
