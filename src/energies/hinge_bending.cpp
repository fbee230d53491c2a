#include "energies/hinge_bending.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace taut {
namespace {

using Matrix12 = Eigen::Matrix<double, 12, 12>;

Matrix3 cross_matrix(const Vector3& v) {
  Matrix3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// One side of the hinge: how theta turns with the triangle on edge x0 x1 with apex `k` (2 or 3). theta' has s_j w at
/// node j with w = N/|N|^2, N = e x (x_k - x0), and s = (-L + t/L, -t/L, L), t = (x_k - x0).e, L = |e|; `sign` is -1
/// for apex 2 and +1 for apex 3.
struct Side {
  Vector3 e, a, normal, w;
  double length, t, square, sign;
  int apex;

  Side(const Eigen::Map<const Eigen::Matrix<double, 3, 4>>& x, int k)
      : e(x.col(1) - x.col(0)), a(x.col(k) - x.col(0)), apex(k) {
    normal = e.cross(a);
    square = normal.squaredNorm();
    w = normal / square;
    length = e.norm();
    t = a.dot(e);
    sign = k == 2 ? -1.0 : 1.0;
  }

  /// Adds scale * d(theta')/dx of this side.
  void add_hessian(double scale, Matrix12& h) const {
    const std::array<int, 3> nodes{0, 1, apex};
    const std::array<double, 3> s{t / length - length, -t / length, length};
    const Vector3 dl = e / length;                 // dL/dx1 = -dL/dx0
    const Vector3 dt0 = -e - a, dt1 = a, dtk = e;  // dt
    const auto ratio = [&](const Vector3& dt, double l) -> Vector3 {
      return dt / length - (t / (length * length)) * l * dl;
    };
    const std::array<Vector3, 3> dratio{ratio(dt0, -1), ratio(dt1, 1), ratio(dtk, 0)};  // d(t/L)
    const std::array<Vector3, 3> dlength{-dl, dl, Vector3::Zero()};
    const Matrix3 reflect = (Matrix3::Identity() - 2 * normal * w.transpose()) / square;
    const Matrix3 ea = cross_matrix(a), ee = cross_matrix(e);
    const std::array<Matrix3, 3> dw{reflect * (ea - ee), -reflect * ea, reflect * ee};
    for (int k = 0; k < 3; ++k) {
      const std::array<Vector3, 3> ds{dratio[k] - dlength[k], -dratio[k], dlength[k]};
      for (int j = 0; j < 3; ++j) {
        h.block<3, 3>(3 * nodes[j], 3 * nodes[k]) += (scale * sign) * (w * ds[j].transpose() + s[j] * dw[k]);
      }
    }
  }
};

}  // namespace

double hinge_angle(const double* x) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 4>> p(x);
  const Vector3 e = p.col(1) - p.col(0), b = p.col(3) - p.col(0), n1 = e.cross(p.col(2) - p.col(0));
  return std::atan2(-e.norm() * n1.dot(b), n1.dot(b.cross(e)));
}

namespace {

/// Two triangles at an edge that runs from corner k to corner k + 1 of both, in opposite directions.
struct InnerEdge {
  std::size_t first, second;
  int first_corner, second_corner;
};

std::vector<InnerEdge> inner_edges(const std::vector<Triangle>& triangles) {
  std::vector<InnerEdge> inner;
  std::map<std::pair<int, int>, std::pair<std::size_t, int>>
      seen;  // directed edge -> (triangle, corner where it starts)
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int from = triangles[t][k], to = triangles[t][(k + 1) % 3];
      const auto other = seen.find({to, from});
      if (other == seen.end()) {
        seen[{from, to}] = {t, k};
      } else {
        inner.push_back({other->second.first, t, other->second.second, k});
      }
    }
  }
  return inner;
}

/// The hinge of an edge with rest angle 0, from the rest lengths of its edge in either triangle and the sum of their
/// rest areas.
Hinge flat_hinge(const std::vector<Triangle>& triangles, const InnerEdge& edge, double length_squared, double areas,
                 double bending_stiffness, int first_vertex) {
  const Triangle &first = triangles[edge.first], &second = triangles[edge.second];
  const int k = edge.first_corner;
  Hinge hinge{{first[k], first[(k + 1) % 3], first[(k + 2) % 3], second[(edge.second_corner + 2) % 3]},
              3 * bending_stiffness * length_squared / areas,
              0};
  for (int& vertex : hinge.vertices) vertex += first_vertex;
  return hinge;
}

}  // namespace

std::vector<Hinge> make_hinges(const std::vector<Triangle>& triangles, const std::vector<Vector3>& rest_positions,
                               double bending_stiffness, bool flat_rest, int first_vertex) {
  const auto area = [&](const Triangle& t) {
    return 0.5 *
           (rest_positions[t[1]] - rest_positions[t[0]]).cross(rest_positions[t[2]] - rest_positions[t[0]]).norm();
  };
  std::vector<Hinge> hinges;
  for (const InnerEdge& edge : inner_edges(triangles)) {
    const Triangle &first = triangles[edge.first], &second = triangles[edge.second];
    const double length_squared =
        (rest_positions[first[(edge.first_corner + 1) % 3]] - rest_positions[first[edge.first_corner]]).squaredNorm();
    hinges.push_back(
        flat_hinge(triangles, edge, length_squared, area(first) + area(second), bending_stiffness, first_vertex));
    if (flat_rest) continue;
    std::array<double, 12> x;
    for (int i = 0; i < 4; ++i)
      std::copy_n(rest_positions[hinges.back().vertices[i] - first_vertex].data(), 3, x.begin() + 3 * i);
    hinges.back().rest_angle = hinge_angle(x.data());
  }
  return hinges;
}

std::vector<Hinge> make_hinges(const std::vector<Triangle>& triangles,
                               const std::vector<std::array<Vector2, 3>>& corners, double bending_stiffness,
                               int first_vertex) {
  const auto area = [&](std::size_t t) {
    const Vector2 e1 = corners[t][1] - corners[t][0], e2 = corners[t][2] - corners[t][0];
    return 0.5 * std::abs(e1.x() * e2.y() - e1.y() * e2.x());
  };
  const auto length_squared = [&](std::size_t t, int k) {
    return (corners[t][(k + 1) % 3] - corners[t][k]).squaredNorm();
  };
  std::vector<Hinge> hinges;
  for (const InnerEdge& edge : inner_edges(triangles)) {
    const double mean =
        0.5 * (length_squared(edge.first, edge.first_corner) + length_squared(edge.second, edge.second_corner));
    hinges.push_back(
        flat_hinge(triangles, edge, mean, area(edge.first) + area(edge.second), bending_stiffness, first_vertex));
  }
  return hinges;
}

HingeBending::HingeBending(std::string name, std::vector<Hinge> hinges)
    : name_(std::move(name)), hinges_(std::move(hinges)) {
  for (const Hinge& hinge : hinges_) stencils_.add_vertices(hinge.vertices);
  const auto count = static_cast<Index>(hinges_.size());
  for (Index quad = 0; quad < quads(count); ++quad) {
    const auto hinge = [&](int lane) -> const Hinge& { return hinges_[element_of(quad, lane, count)]; };
    quads_.push_back({lanes_of([&](int lane) { return hinge(lane).stiffness; }),
                      lanes_of([&](int lane) { return hinge(lane).rest_angle; })});
  }
}

namespace {

/// Energy, gradient and the Gauss-Newton part of the Hessian of one hinge or four; with `off` = theta - rest on return.
template <class Real>
Real evaluate_hinge(Real stiffness, Real rest_angle, const Real* x, Real* gradient, Real* hessian, Real& off) {
  const auto from_first = [&](int node) {
    return std::array<Real, 3>{x[3 * node] - x[0], x[3 * node + 1] - x[1], x[3 * node + 2] - x[2]};
  };
  const auto dot = [](const std::array<Real, 3>& u, const std::array<Real, 3>& v) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  };
  const auto cross = [](const std::array<Real, 3>& u, const std::array<Real, 3>& v) {
    return std::array<Real, 3>{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  };
  const auto e = from_first(1), a = from_first(2), b = from_first(3), n1 = cross(e, a), n2 = cross(b, e);
  const Real length = square_root(dot(e, e));
  off = arc_tangent(-length * dot(n1, b), dot(n1, n2)) - rest_angle;
  const Real value = 0.5 * stiffness * off * off;
  if (!gradient) return value;
  const Real ta = dot(a, e) / length, tb = dot(b, e) / length, w1 = 1.0 / dot(n1, n1), w2 = 1.0 / dot(n2, n2);
  std::array<Real, 12> slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Real turn1 = n1[axis] * w1, turn2 = n2[axis] * w2;
    slope[axis] = (length - ta) * turn1 + (length - tb) * turn2;
    slope[3 + axis] = ta * turn1 + tb * turn2;
    slope[6 + axis] = -length * turn1;
    slope[9 + axis] = -length * turn2;
  }
  for (int i = 0; i < 12; ++i) gradient[i] = stiffness * off * slope[i];
  if (!hessian) return value;
  for (int j = 0; j < 12; ++j) {
    const Real factor = stiffness * slope[j];
    for (int i = 0; i < 12; ++i) hessian[12 * j + i] = factor * slope[i];
  }
  return value;
}

}  // namespace

Pack HingeBending::evaluate_four(Index quad, const Pack* x, Pack* gradient, Pack* hessian,
                                 Curvature /*curvature*/) const {
  Pack off;
  return evaluate_hinge(quads_[quad].stiffness, quads_[quad].rest_angle, x, gradient, hessian, off);
}

double HingeBending::evaluate(Index element, const double* x, double* gradient, double* hessian,
                              Curvature curvature) const {
  const Hinge& hinge = hinges_[element];
  double off;
  const double value = evaluate_hinge(hinge.stiffness, hinge.rest_angle, x, gradient, hessian, off);
  if (hessian && curvature == Curvature::exact) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 4>> p(x);
    Matrix12 turn = Matrix12::Zero();
    Side(p, 2).add_hessian(hinge.stiffness * off, turn);
    Side(p, 3).add_hessian(hinge.stiffness * off, turn);
    Eigen::Map<Matrix12>{hessian} += 0.5 * (turn + turn.transpose());
  }
  return value;
}

}  // namespace taut
