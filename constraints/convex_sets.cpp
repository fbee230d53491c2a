#include "constraints/convex_sets.h"

#include <algorithm>
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
struct Smoothed {
  double correction = 0, slope = 1, rate = 0;
};

Smoothed smoothed(double z, double lower, double upper, double epsilon) {
  Smoothed out;
  // One bound: correction (y + r)/2 and slope (1 - y/r)/2, r = sqrt(y^2 + 4 epsilon). With `small` the smaller root
  // (r - |y|)/2 both are without cancellation.
  const auto add = [&](double y, double sign) {
    const double r = std::sqrt(y * y + 4 * epsilon), inverse = 1 / r, small = 2 * epsilon / (r + std::abs(y));
    out.rate += sign * inverse;
    out.correction += sign * (y >= 0 ? y + small : small);
    // Between two bounds the slopes' deficits add up; the larger deficit is kept as a slope so that nothing cancels.
    const double slope = y >= 0 ? small * inverse : 1 - small * inverse, deficit = y >= 0 ? 1 - slope : small * inverse;
    out.slope = slope < out.slope ? slope - (1 - out.slope) : out.slope - deficit;
  };
  if (std::isfinite(upper)) add(z - upper, 1.0);
  if (std::isfinite(lower)) add(lower - z, -1.0);
  out.slope = std::max(out.slope, smallest_slope);
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
    const Smoothed s = smoothed(z[i], lower_, upper_, epsilon);
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

void SpectralBox::project_smoothed(Index /*element*/, const double* z, double epsilon, double* nearest, double* inverse,
                                   double* rate) const {
  constexpr double root2 = std::numbers::sqrt2;
  const Eigen2 pair = eigen2(z[0], z[1] / root2, z[2]);
  const double y1 = pair.values[0], y2 = pair.values[1], gap = y1 - y2;
  const Smoothed s1 = smoothed(y1, lower_, upper_, epsilon), s2 = smoothed(y2, lower_, upper_, epsilon);
  const double c = pair.vectors(0, 0), s = pair.vectors(1, 0);
  const Vector3 e1(c * c, root2 * c * s, s * s), e2(s * s, -root2 * c * s, c * c),
      e12(-root2 * c * s, c * c - s * s, root2 * c * s);
  double omega = 0.5 * (s1.slope + s2.slope);
  if (gap > 1e-7 * (std::abs(y1) + std::abs(y2))) {
    omega = std::clamp(1 - (s1.correction - s2.correction) / gap, std::min(s1.slope, s2.slope), 1.0);
  }
  Eigen::Map<Vector3>{nearest} = Eigen::Map<const Vector3>(z) - s1.correction * e1 - s2.correction * e2;
  Eigen::Map<Vector3>{rate} = -s1.rate * e1 - s2.rate * e2;
  const Vector3 f1 = e1 / s1.slope, f2 = e2 / s2.slope, f12 = e12 / omega;
  Eigen::Map<Matrix3>{inverse} = f1 * e1.transpose() + f2 * e2.transpose() + f12 * e12.transpose();
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
