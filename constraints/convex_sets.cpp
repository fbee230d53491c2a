#include "constraints/convex_sets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "linalg/symmetric2.h"

namespace taut {
namespace {

void check_bounds(const char* owner, double lower, double upper) {
  if (!(lower <= upper)) {
    throw std::invalid_argument(std::string(owner) + ": lower " + std::to_string(lower) + " must not exceed upper " +
                                std::to_string(upper));
  }
}

/// The smoothed projection of a number onto [lower, upper]: how far z moves down, the slope of the projection, and the
/// derivative of the correction in epsilon.
constexpr double smallest_slope = 1e-8;
template <class Real>
struct Smoothed {
  Real correction = 0, slope = 1, rate = 0;
};

template <class Real>
Smoothed<Real> smoothed(Real z, double lower, double upper, double epsilon) {
  Smoothed<Real> out;
  // One bound: correction (y + r)/2 and slope (1 - y/r)/2, r = sqrt(y^2 + 4 epsilon). With `small` the smaller root
  // (r - |y|)/2 both are without cancellation.
  const auto add = [&](Real y, double sign) {
    const Real r = square_root(y * y + 4 * epsilon), inverse = 1.0 / r, small = 2 * epsilon / (r + absolute(y));
    const Real part = small * inverse;
    const auto beyond = y >= Real(0.0);
    out.rate += sign * inverse;
    out.correction += sign * select(beyond, y + small, small);
    // Between two bounds the slopes' deficits add up; the larger deficit is kept as a slope so that nothing cancels.
    const Real slope = select(beyond, part, 1.0 - part), deficit = select(beyond, 1.0 - part, part);
    out.slope = select(slope < out.slope, slope - (1.0 - out.slope), out.slope - deficit);
  };
  if (std::isfinite(upper)) add(z - upper, 1.0);
  if (std::isfinite(lower)) add(lower - z, -1.0);
  out.slope = larger(out.slope, Real(smallest_slope));
  return out;
}

}  // namespace

Box::Box(int dimension, double lower, double upper) : dimension_(dimension), lower_(lower), upper_(upper) {
  check_bounds("Box", lower, upper);
}

void Box::project(Index /*element*/, const double* z, double* nearest, double* derivative) const {
  if (derivative) std::fill_n(derivative, dimension_ * dimension_, 0.0);
  for (int i = 0; i < dimension_; ++i) {
    const bool inside = z[i] >= lower_ && z[i] <= upper_;
    nearest[i] = inside || std::isnan(z[i]) ? z[i] : std::clamp(z[i], lower_, upper_);
    if (derivative) derivative[i * dimension_ + i] = inside ? 1.0 : 0.0;
  }
}

bool Box::contains_ball(Index /*element*/, const double* z, double radius) const {
  return std::all_of(z, z + dimension_,
                     [&](double value) { return value - radius >= lower_ && value + radius <= upper_; });
}

void Box::project_smoothed(Index /*element*/, const double* z, double epsilon, double* nearest, double* inverse,
                           double* rate) const {
  std::fill_n(inverse, dimension_ * dimension_, 0.0);
  for (int i = 0; i < dimension_; ++i) {
    const Smoothed<double> s = smoothed(z[i], lower_, upper_, epsilon);
    nearest[i] = z[i] - s.correction;
    inverse[i * dimension_ + i] = 1 / s.slope;
    rate[i] = -s.rate;
  }
}

void Box::smooth_bounds(double* lower, double* upper) const {
  std::fill_n(lower, dimension_, lower_);
  std::fill_n(upper, dimension_, upper_);
}

void Box::smooth_values(Index /*element*/, const double* z, double* g, double* jacobian) const {
  std::copy_n(z, dimension_, g);
  if (jacobian) Eigen::Map<Matrix>(jacobian, dimension_, dimension_).setIdentity();
}

void Box::smooth_hessian(Index /*element*/, const double* /*z*/, const double* /*weights*/, double* hessian) const {
  std::fill_n(hessian, dimension_ * dimension_, 0.0);
}

SpectralBox::SpectralBox(double lower, double upper)
    : lower_(lower),
      upper_(upper),
      smooth_scale_(
          std::max(std::isfinite(lower) ? std::abs(lower) : 0.0, std::isfinite(upper) ? std::abs(upper) : 0.0)) {
  check_bounds("SpectralBox", lower, upper);
  if (smooth_scale_ == 0) smooth_scale_ = 1;
}

void SpectralBox::project(Index /*element*/, const double* z, double* nearest, double* derivative) const {
  constexpr double root2 = std::numbers::sqrt2;
  const Eigen2 pair = eigen2(z[0], z[1] / root2, z[2]);
  const double y1 = pair.values[0], y2 = pair.values[1];
  if (y1 <= upper_ && y2 >= lower_) {
    std::copy_n(z, 3, nearest);
    if (derivative) Eigen::Map<Matrix3>{derivative}.setIdentity();
    return;
  }
  const double p1 = std::clamp(y1, lower_, upper_), p2 = std::clamp(y2, lower_, upper_);
  const double c = pair.vectors(0, 0), s = pair.vectors(1, 0);
  const Vector3 e1(c * c, root2 * c * s, s * s), e2(s * s, -root2 * c * s, c * c);
  Eigen::Map<Vector3>{nearest} = Eigen::Map<const Vector3>(z) + (p1 - y1) * e1 + (p2 - y2) * e2;
  if (derivative) {
    const double slope1 = y1 >= lower_ && y1 <= upper_ ? 1.0 : 0.0, slope2 = y2 >= lower_ && y2 <= upper_ ? 1.0 : 0.0;
    const double gap = y1 - y2;
    const double omega = gap > 1e-14 * (std::abs(y1) + std::abs(y2)) ? (p1 - p2) / gap : 0.5 * (slope1 + slope2);
    const Vector3 e12(-root2 * c * s, c * c - s * s, root2 * c * s);
    Eigen::Map<Matrix3>{derivative} =
        slope1 * e1 * e1.transpose() + slope2 * e2 * e2.transpose() + omega * e12 * e12.transpose();
  }
}

/// No eigenvalue moves by more than the matrix does, in Frobenius' norm (Weyl).
bool SpectralBox::contains_ball(Index /*element*/, const double* z, double radius) const {
  const Eigen2 pair = eigen2(z[0], z[1] / std::numbers::sqrt2, z[2]);
  return pair.values[1] - radius >= lower_ && pair.values[0] + radius <= upper_;
}

/// With the projectors e1 e1^T, e2 e2^T onto the eigenvectors and their mixed product e12 in the coordinates of z.
template <class Real>
void SpectralBox::project_smoothed(const Real* z, double epsilon, Real* nearest, Real* inverse, Real* rate) const {
  constexpr double root2 = std::numbers::sqrt2, half_root2 = 0.5 * root2;
  const Spectrum2<Real> spectrum({z[0], half_root2 * z[1], z[2]});
  const Real y1 = spectrum.high(), y2 = spectrum.low(), gap = 2.0 * spectrum.radius;
  const Smoothed<Real> s1 = smoothed(y1, lower_, upper_, epsilon), s2 = smoothed(y2, lower_, upper_, epsilon);
  const Real least = smaller(s1.slope, s2.slope);
  const Real divided = smaller(larger(1.0 - (s1.correction - s2.correction) / gap, least), Real(1.0));
  const Real omega = select(gap > 1e-7 * (absolute(y1) + absolute(y2)), divided, 0.5 * (s1.slope + s2.slope));
  const Symmetric2<Real> down = spectrum.with_values(s1.correction, s2.correction);
  const Symmetric2<Real> rates = spectrum.with_values(s1.rate, s2.rate);
  nearest[0] = z[0] - down.a;
  nearest[1] = z[1] - root2 * down.b;
  nearest[2] = z[2] - down.c;
  rate[0] = -rates.a;
  rate[1] = -root2 * rates.b;
  rate[2] = -rates.c;
  const Real cc = spectrum.cc, ss = spectrum.ss, mixed = root2 * spectrum.cs;
  const std::array<Real, 3> e1{cc, mixed, ss}, e2{ss, -mixed, cc}, e12{-mixed, spectrum.cosine, mixed};
  const Real inverse1 = 1.0 / s1.slope, inverse2 = 1.0 / s2.slope, inverse12 = 1.0 / omega;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      inverse[3 * j + i] = inverse1 * e1[i] * e1[j] + inverse2 * e2[i] * e2[j] + inverse12 * e12[i] * e12[j];
  }
}

void SpectralBox::project_smoothed(Index /*element*/, const double* z, double epsilon, double* nearest, double* inverse,
                                   double* rate) const {
  project_smoothed<double>(z, epsilon, nearest, inverse, rate);
}

void SpectralBox::project_smoothed_four(Index /*quad*/, const Pack* z, double epsilon, Pack* nearest, Pack* inverse,
                                        Pack* rate) const {
  project_smoothed<Pack>(z, epsilon, nearest, inverse, rate);
}

int SpectralBox::smooth_rows() const {
  if (lower_ == upper_) return 3;
  return (std::isfinite(lower_) ? 2 : 0) + (std::isfinite(upper_) ? 2 : 0);
}

void SpectralBox::smooth_bounds(double* lower, double* upper) const {
  if (lower_ == upper_) {
    const Vector3 point = Vector3(lower_, 0, lower_) / smooth_scale_;
    Eigen::Map<Vector3>{lower} = point;
    Eigen::Map<Vector3>{upper} = point;
    return;
  }
  std::fill_n(lower, smooth_rows(), 0.0);
  std::fill_n(upper, smooth_rows(), std::numeric_limits<double>::infinity());
}

void SpectralBox::smooth_values(Index /*element*/, const double* z, double* g, double* jacobian) const {
  const double s = smooth_scale_;
  if (lower_ == upper_) {
    for (int i = 0; i < 3; ++i) g[i] = z[i] / s;
    if (jacobian) Eigen::Map<Matrix3>{jacobian} = Matrix3::Identity() / s;
    return;
  }
  const int rows = smooth_rows();
  int row = 0;
  // A = sign (z - limit I)/s has the diagonal (a, c) and the square of its off-diagonal z1^2/(2 s^2).
  const auto add = [&](double limit, double sign) {
    const double a = sign * (z[0] - limit) / s, c = sign * (z[2] - limit) / s, b = z[1] / s;
    g[row] = a + c;
    g[row + 1] = a * c - 0.5 * b * b;
    if (jacobian) {
      Eigen::Map<Matrix> j(jacobian, rows, 3);
      j.row(row) << sign / s, 0.0, sign / s;
      j.row(row + 1) << sign * c / s, -b / s, sign * a / s;
    }
    row += 2;
  };
  if (std::isfinite(upper_)) add(upper_, -1);
  if (std::isfinite(lower_)) add(lower_, 1);
}

void SpectralBox::smooth_hessian(Index /*element*/, const double* /*z*/, const double* weights, double* hessian) const {
  Eigen::Map<Matrix3> h(hessian);
  h.setZero();
  if (lower_ == upper_) return;
  double determinants = 0;
  for (int row = 1; row < smooth_rows(); row += 2) determinants += weights[row];
  h(0, 2) = h(2, 0) = determinants / (smooth_scale_ * smooth_scale_);
  h(1, 1) = -h(0, 2);
}

}  // namespace taut
