#include "dynamics/modal/warping.h"

#include <cmath>

namespace taut {
namespace {

constexpr int terms = 10;

/// (-1)^k / (2k+2)! and (-1)^k / (2k+3)!.
struct SeriesTable {
  double even[terms] = {}, odd[terms] = {};
  constexpr SeriesTable() {
    double term = 0.5;
    for (int k = 0; k < terms; ++k) {
      even[k] = term;
      odd[k] = term / (2 * k + 3);
      term /= -(2.0 * k + 3) * (2 * k + 4);
    }
  }
};
constexpr SeriesTable table;

/// a = (1 - cos t)/t^2 and b = (t - sin t)/t^3 as functions of s = t^2, with their first two derivatives in s.
struct Coefficients {
  double a, a1, a2, b, b1, b2;

  explicit Coefficients(double s) {
    if (s < 0.5) {  // where the closed forms cancel
      series(s);
      return;
    }
    const double t = std::sqrt(s), c = std::cos(t), n = std::sin(t);
    a = (1 - c) / s;
    b = (t - n) / (s * t);
    a1 = (0.5 * n / t - a) / s;
    b1 = (0.5 * a - 1.5 * b) / s;
    // (n / t)' = (c - n / t) / (2 s)
    a2 = (0.25 * (c - n / t) / s - 2 * a1) / s;
    b2 = (0.5 * a1 - 2.5 * b1) / s;
  }

 private:
  /// a = sum (-s)^k / (2k+2)!, b = sum (-s)^k / (2k+3)!.
  void series(double s) {
    a = a1 = a2 = b = b1 = b2 = 0;
    for (int k = terms - 1; k >= 0; --k) {  // Horner's scheme for the polynomial and its derivatives
      a2 = a2 * s + a1;
      b2 = b2 * s + b1;
      a1 = a1 * s + a;
      b1 = b1 * s + b;
      a = a * s + table.even[k];
      b = b * s + table.odd[k];
    }
    a2 *= 2;
    b2 *= 2;
  }
};

Matrix3 cross(const Vector3& w) {
  Matrix3 m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}

}  // namespace

Matrix3 warp_rotation(const Vector3& w) {
  const Coefficients c(w.squaredNorm());
  const Matrix3 x = cross(w);
  return Matrix3::Identity() + (1 - c.b * w.squaredNorm()) * x + c.a * x * x;
}

Matrix3 warp_integral(const Vector3& w) {
  const Coefficients c(w.squaredNorm());
  const Matrix3 x = cross(w);
  return Matrix3::Identity() + c.a * x + c.b * x * x;
}

Matrix3 warp_derivative(const Vector3& d, const Vector3& w) {
  // u = d + a w x d + b (w (w.d) - s d)
  const double s = w.squaredNorm();
  const Coefficients c(s);
  const Vector3 turned = w.cross(d), pulled = w * w.dot(d) - s * d;
  return -c.a * cross(d) + 2 * c.a1 * turned * w.transpose() +
         c.b * (w.dot(d) * Matrix3::Identity() + w * d.transpose() - 2 * d * w.transpose()) +
         2 * c.b1 * pulled * w.transpose();
}

Matrix6 warp_hessian(const Vector3& f, const Vector3& d, const Vector3& w) {
  const double s = w.squaredNorm();
  const Coefficients c(s);
  const Matrix3 identity = Matrix3::Identity();
  // f.u = f.d + a p + b q with p = w.(d x f), q = (w.d)(w.f) - s (d.f)
  const Vector3 p1 = d.cross(f), q1 = w.dot(f) * d + w.dot(d) * f - 2 * d.dot(f) * w;
  const double p = w.dot(p1), q = w.dot(d) * w.dot(f) - s * d.dot(f);
  const Matrix3 mixed_p = w * p1.transpose(), mixed_q = w * q1.transpose();
  Matrix6 h = Matrix6::Zero();
  h.bottomRightCorner<3, 3>() = 2 * c.a1 * (mixed_p + mixed_p.transpose() + p * identity) +
                                4 * (c.a2 * p + c.b2 * q) * w * w.transpose() +
                                c.b * (d * f.transpose() + f * d.transpose() - 2 * d.dot(f) * identity) +
                                2 * c.b1 * (mixed_q + mixed_q.transpose() + q * identity);
  // R~^T f = f - a w x f + b (w (w.f) - s f), differentiated in w: the derivative of R~(-w) f.
  h.topRightCorner<3, 3>() = -warp_derivative(f, -w);
  h.bottomLeftCorner<3, 3>() = h.topRightCorner<3, 3>().transpose();
  return h;
}

}  // namespace taut
