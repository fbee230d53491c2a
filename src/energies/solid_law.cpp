#include "energies/solid_law.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace taut {
namespace {

/// Rows and columns of a tensor in the order of Voigt.
constexpr std::array<std::array<int, 2>, 6> voigt_axes{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

/// x - ln(1 + x), with all digits near zero.
double beyond_logarithm(double x) {
  if (std::abs(x) > 0.01) return x - std::log1p(x);
  double sum = 0;  // x^2/2 - x^3/3 + ...
  for (int n = 9; n >= 2; --n) sum = 1.0 / n - x * sum;
  return x * x * sum;
}

Elasticity checked(const Elasticity& elasticity) {
  if (!elasticity.allFinite() || Eigen::LLT<Elasticity>(elasticity).info() != Eigen::Success) {
    throw std::invalid_argument("SolidMaterial: expected moduli with a positive definite elasticity");
  }
  return elasticity;
}

}  // namespace

SolidMaterial SolidMaterial::isotropic(SolidLaw law, double young_modulus, double poisson_ratio) {
  SolidMaterial material;
  material.law = law;
  material.lambda = young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  material.mu = young_modulus / (2 * (1 + poisson_ratio));
  material.elasticity.diagonal().head<3>().setConstant(2 * material.mu);
  material.elasticity.diagonal().tail<3>().setConstant(material.mu);
  material.elasticity.topLeftCorner<3, 3>().array() += material.lambda;
  checked(material.elasticity);
  return material;
}

SolidMaterial SolidMaterial::ply(const PlyModuli& m) {
  Elasticity compliance = Elasticity::Zero();
  compliance.diagonal() << 1 / m.e_l, 1 / m.e_t, 1 / m.e_t, 1 / m.g_lt, 1 / m.g_lt, 1 / m.g_tt;
  compliance(0, 1) = compliance(1, 0) = compliance(0, 2) = compliance(2, 0) = -m.nu_lt / m.e_l;
  compliance(1, 2) = compliance(2, 1) = -m.nu_tt / m.e_t;
  SolidMaterial material;
  material.elasticity = checked(compliance).inverse();
  return material;
}

NeoHookeanPoint::NeoHookeanPoint(const SolidMaterial& material, const Voigt& strain)
    : lambda_(material.lambda), mu_(material.mu) {
  Matrix3 e;
  e << strain[0], 0.5 * strain[3], 0.5 * strain[4],  //
      0.5 * strain[3], strain[1], 0.5 * strain[5],   //
      0.5 * strain[4], 0.5 * strain[5], strain[2];
  // Invariants of E instead of C: at small strains 1 would swallow their digits.
  const double second = e(0, 0) * e(1, 1) + e(1, 1) * e(2, 2) + e(2, 2) * e(0, 0) - e(0, 1) * e(0, 1) -
                        e(0, 2) * e(0, 2) - e(1, 2) * e(1, 2);
  const double higher = 2 * second + 4 * e.determinant();
  growth_ = 2 * (e.trace() + higher);
  const Matrix3 c = Matrix3::Identity() + 2 * e;
  valid = c(0, 0) > 0 && c(0, 0) * c(1, 1) > c(0, 1) * c(0, 1) && growth_ > -1;
  if (!valid) return;
  inverse_ = c.inverse();
  density = (0.25 * lambda_ + 0.5 * mu_) * beyond_logarithm(growth_) - mu_ * higher;
  const Matrix3 s = 2 * mu_ * inverse_ * e + 0.5 * lambda_ * growth_ * inverse_;
  for (int a = 0; a < 6; ++a) {
    const auto [i, j] = voigt_axes[a];
    stress[a] = s(i, j);
  }
}

Elasticity NeoHookeanPoint::tangent(bool semidefinite) const {
  const double bulk = lambda_ * (1 + growth_);
  const double shear = 2 * mu_ - lambda_ * growth_;
  const double half = 0.5 * (semidefinite ? std::max(shear, 0.0) : shear);
  Elasticity d;
  for (int a = 0; a < 6; ++a) {
    const auto [i, j] = voigt_axes[a];
    for (int b = a; b < 6; ++b) {
      const auto [k, l] = voigt_axes[b];
      d(a, b) = d(b, a) = bulk * inverse_(i, j) * inverse_(k, l) +
                          half * (inverse_(i, k) * inverse_(j, l) + inverse_(i, l) * inverse_(j, k));
    }
  }
  return d;
}

}  // namespace taut
