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
  Matrix3 c;
  c << 1 + 2 * strain[0], strain[3], strain[4],  //
      strain[3], 1 + 2 * strain[1], strain[5],   //
      strain[4], strain[5], 1 + 2 * strain[2];
  determinant_ = c.determinant();
  valid = c(0, 0) > 0 && c(0, 0) * c(1, 1) > c(0, 1) * c(0, 1) && determinant_ > 0;
  if (!valid) return;
  inverse_ = c.inverse();
  const double volume = 0.5 * lambda_ * (determinant_ - 1);
  density = 0.5 * mu_ * (c.trace() - 3) + 0.5 * volume - (0.25 * lambda_ + 0.5 * mu_) * std::log(determinant_);
  for (int a = 0; a < 6; ++a) {
    const auto [i, j] = voigt_axes[a];
    stress[a] = (i == j ? mu_ : 0.0) + (volume - mu_) * inverse_(i, j);
  }
}

Elasticity NeoHookeanPoint::tangent(bool semidefinite) const {
  const double bulk = lambda_ * determinant_;
  const double shear = 2 * mu_ - lambda_ * (determinant_ - 1);
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
