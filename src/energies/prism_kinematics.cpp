#include "energies/prism_kinematics.h"

#include <cmath>

namespace taut {
namespace {

using Coefficients = Eigen::Matrix<double, 5, 1>;

/// Half the change of the inner product of two vectors, p and q in terms of the five, as coefficients of a GramStrain.
GramStrain half_product(const Coefficients& p, const Coefficients& q) {
  GramStrain row = GramStrain::Zero();
  for (int k = 0; k < 5; ++k) {
    row[gram_pair(k, k)] = p[k] * q[k];
    for (int l = k + 1; l < 5; ++l) row[gram_pair(k, l)] = 0.5 * (p[k] * q[l] + p[l] * q[k]);
  }
  return row;
}

/// The map from covariant strains to strains in an orthonormal frame, E = J^-T e J^-1, in Voigt's order.
Elasticity to_frame(const Matrix3& inverse) {
  static constexpr int axes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  Elasticity map;
  for (int a = 0; a < 6; ++a) {
    const int i = axes[a][0], j = axes[a][1];
    for (int b = 0; b < 6; ++b) {
      const int k = axes[b][0], l = axes[b][1];
      const double once = inverse(k, i) * inverse(l, j);
      // A shear column stands for both orders of its axes, and shear rows and columns are doubled alike.
      map(a, b) = (a < 3 ? 1.0 : 2.0) * (b < 3 ? once : 0.5 * (once + inverse(l, i) * inverse(k, j)));
    }
  }
  return map;
}

}  // namespace

PrismVectors prism_vectors(const double* y) {
  const Eigen::Map<const Eigen::Matrix<double, 3, 6>> nodes(y);
  PrismVectors v;
  const Vector3 first = nodes.col(0) + nodes.col(1);
  v.col(0) = 0.5 * (nodes.col(2) + nodes.col(3) - first);
  v.col(1) = 0.5 * (nodes.col(4) + nodes.col(5) - first);
  for (int j = 0; j < 3; ++j) v.col(2 + j) = 0.5 * (nodes.col(2 * j + 1) - nodes.col(2 * j));
  return v;
}

GramStrain gram(const PrismVectors& v) {
  GramStrain products = GramStrain::Zero();
  for (int k = 0; k < 5; ++k) {
    products[gram_pair(k, k)] = 0.5 * v.col(k).squaredNorm();
    for (int l = k + 1; l < 5; ++l) products[gram_pair(k, l)] = v.col(k).dot(v.col(l));
  }
  return products;
}

TangentCoefficients tangents(const Vector3& l, double gamma) {
  TangentCoefficients g;
  g.col(0) << 1, 0, -gamma, gamma, 0;
  g.col(1) << 0, 1, -gamma, 0, gamma;
  g.col(2) << 0, 0, l;
  return g;
}

PrismKinematics::PrismKinematics(const PrismShape& rest, const Vector3& direction, PrismElement element,
                                 double shear_factor)
    : element_(element), shear_scale_(std::sqrt(shear_factor)) {
  rest_.col(0) = rest.mid.col(1) - rest.mid.col(0);
  rest_.col(1) = rest.mid.col(2) - rest.mid.col(0);
  rest_.rightCols<3>() = rest.director;
  const Vector3 normal = rest_.col(0).cross(rest_.col(1)).normalized();
  Vector3 axis = direction - direction.dot(normal) * normal;
  if (!(axis.norm() > 0.0175 * direction.norm())) axis = rest_.col(0);
  frame_.col(0) = axis.normalized();
  frame_.col(1) = normal.cross(frame_.col(0));
  frame_.col(2) = normal;
}

Matrix3 PrismKinematics::jacobian(const Vector3& l, double gamma) const {
  return frame_.transpose() * rest_ * tangents(l, gamma);
}

StrainMatrix covariant_strain(PrismElement element, const Vector3& l, double gamma) {
  const TangentCoefficients g = tangents(l, gamma);
  StrainMatrix e;
  e.col(0) = half_product(g.col(0), g.col(0));
  e.col(1) = half_product(g.col(1), g.col(1));
  e.col(3) = 2 * half_product(g.col(0), g.col(1));
  if (element == PrismElement::plain) {
    e.col(2) = half_product(g.col(2), g.col(2));
    e.col(4) = 2 * half_product(g.col(0), g.col(2));
    e.col(5) = 2 * half_product(g.col(1), g.col(2));
    return e;
  }
  const auto thickness = [](int vertex) {
    const Coefficients n = Coefficients::Unit(2 + vertex);
    return half_product(n, n);
  };
  e.col(2) = l[0] * thickness(0) + l[1] * thickness(1) + l[2] * thickness(2);
  // Shear along the three edges at their middles and gamma = 0 (Lee and Bathe 2004).
  const Coefficients a1 = Coefficients::Unit(0), a2 = Coefficients::Unit(1);
  const auto edge_shear = [](const Coefficients& edge, int from, int to) {
    return half_product(edge, 0.5 * (Coefficients::Unit(2 + from) + Coefficients::Unit(2 + to)));
  };
  const GramStrain along1 = edge_shear(a1, 0, 1), along2 = edge_shear(a2, 0, 2), along3 = edge_shear(a2 - a1, 1, 2);
  const GramStrain twist = along2 - along1 - along3;
  // The part linear in gamma is half the slope of the thickness strain, with the tied one in its place.
  e.col(4) = 2 * (along1 + l[2] * twist) + gamma * (thickness(1) - thickness(0));
  e.col(5) = 2 * (along2 - l[1] * twist) + gamma * (thickness(2) - thickness(0));
  return e;
}

StrainMatrix PrismKinematics::strain(const StrainMatrix& covariant, const Vector3& l, double gamma) const {
  StrainMatrix e = covariant.lazyProduct(to_frame(jacobian(l, gamma).inverse()).transpose());
  e.rightCols<2>() *= shear_scale_;
  return e;
}

}  // namespace taut
