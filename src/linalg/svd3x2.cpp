#include "linalg/svd3x2.h"

#include "linalg/symmetric2.h"

namespace taut {
namespace {

/// Any unit vector orthogonal to the unit vector u.
Vector3 orthogonal_to(const Vector3& u) {
  Index smallest;
  u.cwiseAbs().minCoeff(&smallest);
  return u.cross(Vector3::Unit(smallest)).normalized();
}

}  // namespace

Vector2 singular_values(const Matrix32& f) {
  const double a = f.col(0).squaredNorm(), c = f.col(1).squaredNorm(), b = f.col(0).dot(f.col(1));
  const double d1 = std::sqrt(0.5 * (a + c) + std::hypot(0.5 * (a - c), b));
  return {d1, d1 > 0 ? f.col(0).cross(f.col(1)).norm() / d1 : 0.0};
}

Svd32 svd(const Matrix32& f) {
  const double a = f.col(0).squaredNorm(), c = f.col(1).squaredNorm(), b = f.col(0).dot(f.col(1));
  const Eigen2 pair = eigen2(a, b, c);
  Svd32 out;
  out.v1 = pair.vectors.col(0);
  out.v2 = pair.vectors.col(1);
  out.d1 = std::sqrt(pair.values[0]);
  if (!(out.d1 > 0)) {
    return {out.d1, 0.0, Vector3::UnitX(), Vector3::UnitY(), Vector3::UnitZ(), out.v1, out.v2};
  }
  out.u1 = (f * out.v1) / out.d1;
  const Vector3 area = f.col(0).cross(f.col(1));  // = d1 d2 n, as v1 x v2 = +1
  const double area_norm = area.norm();
  out.d2 = area_norm / out.d1;
  out.n = area_norm > 1e-300 ? Vector3(area / area_norm) : orthogonal_to(out.u1);
  // Keep the frame orthonormal where d2 is tiny and the area vector is mostly round-off.
  out.n = (out.n - out.n.dot(out.u1) * out.u1).normalized();
  out.u2 = out.n.cross(out.u1);
  return out;
}

}  // namespace taut
