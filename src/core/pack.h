#pragma once

#include <algorithm>
#include <cmath>

#include "core/types.h"

namespace taut {

/// Four doubles on which arithmetic goes lane by lane, whatever is in the other lanes. A kernel written for a `Real`
/// serves one element with double and four with Pack; it has no branches on values, but select().
struct Pack {
  static constexpr int size = 4;
  using Lanes [[gnu::vector_size(size * sizeof(double))]] = double;
  Lanes lanes;

  Pack() = default;
  Pack(double all) : lanes{all, all, all, all} {}
  explicit Pack(Lanes l) : lanes(l) {}
  double operator[](int lane) const { return lanes[lane]; }

  friend Pack operator+(Pack a, Pack b) { return Pack(a.lanes + b.lanes); }
  friend Pack operator-(Pack a, Pack b) { return Pack(a.lanes - b.lanes); }
  friend Pack operator*(Pack a, Pack b) { return Pack(a.lanes * b.lanes); }
  friend Pack operator/(Pack a, Pack b) { return Pack(a.lanes / b.lanes); }
  friend Pack operator-(Pack a) { return Pack(-a.lanes); }
  Pack& operator+=(Pack b) { return *this = *this + b; }
  Pack& operator-=(Pack b) { return *this = *this - b; }
  Pack& operator*=(Pack b) { return *this = *this * b; }
  friend auto operator<(Pack a, Pack b) { return a.lanes < b.lanes; }
  friend auto operator>(Pack a, Pack b) { return a.lanes > b.lanes; }
  friend auto operator>=(Pack a, Pack b) { return a.lanes >= b.lanes; }
};

/// A quad q of elements is 4 q ... 4 q + 3; past the last of them the last one again.
inline Index quads(Index elements) { return (elements + Pack::size - 1) / Pack::size; }
inline Index element_of(Index quad, int lane, Index elements) {
  return std::min(quad * Pack::size + lane, elements - 1);
}

/// f(lane) in each lane.
template <class F>
Pack lanes_of(const F& f) {
  return Pack(Pack::Lanes{f(0), f(1), f(2), f(3)});
}

inline double select(bool condition, double yes, double no) { return condition ? yes : no; }
template <class Condition>
Pack select(Condition condition, Pack yes, Pack no) {
  return Pack(condition ? yes.lanes : no.lanes);
}

/// Of doubles those of <cmath>.
inline double square_root(double a) { return std::sqrt(a); }
inline Pack square_root(Pack a) {
  using Array = Eigen::Array<double, Pack::size, 1>;
  Array root = Array(a[0], a[1], a[2], a[3]).sqrt();
  return lanes_of([&](int lane) { return root[lane]; });
}
/// atan2(y, x).
inline double arc_tangent(double y, double x) { return std::atan2(y, x); }
inline Pack arc_tangent(Pack y, Pack x) {
  return lanes_of([&](int lane) { return std::atan2(y[lane], x[lane]); });
}
inline double absolute(double a) { return std::abs(a); }
inline Pack absolute(Pack a) { return select(a < Pack(0.0), -a, a); }
template <class Real>
Real larger(Real a, Real b) {
  return select(a < b, b, a);
}
template <class Real>
Real smaller(Real a, Real b) {
  return select(b < a, b, a);
}

}  // namespace taut
