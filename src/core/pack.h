#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

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

/// atan2(y, x) to 4e-16 of its magnitude; where both are zero or infinite, not a number.
inline double arc_tangent(double y, double x) { return std::atan2(y, x); }
inline Pack arc_tangent(Pack y, Pack x) {
  constexpr double quarter_pi = 0.25 * std::numbers::pi;
  const Pack u = absolute(x), v = absolute(y), large = larger(u, v), small = smaller(u, v);
  // atan(small/large), from 0.66 on as pi/4 + atan((small - large)/(small + large)).
  const auto steep = small > 0.66 * large;
  const Pack t = select(steep, small - large, small) / select(steep, small + large, large), z = t * t;
  // Rational approximation on |t| <= 0.66 of the Cephes library [Moshier 1989, atan.c].
  const Pack p = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z -
                  1.228866684490136173410e2) *
                     z -
                 6.485021904942025371773e1;
  const Pack q =
      ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z +
       4.853903996359136964868e2) *
          z +
      1.945506571482613964425e2;
  Pack angle = t + t * z * (p / q);
  angle = select(steep, quarter_pi + angle, angle);
  angle = select(v > u, 2 * quarter_pi - angle, angle);
  angle = select(x < Pack(0.0), 4 * quarter_pi - angle, angle);
  return select(y < Pack(0.0), -angle, angle);
}

}  // namespace taut
