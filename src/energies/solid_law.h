#pragma once

#include "core/types.h"

namespace taut {

/// A symmetric strain as (E11, E22, E33, 2 E12, 2 E13, 2 E23) or a stress as (S11, S22, S33, S12, S13, S23).
using Voigt = Eigen::Matrix<double, 6, 1>;
/// dS/dE in that notation, Pa.
using Elasticity = Eigen::Matrix<double, 6, 6>;

/// How the second Piola-Kirchhoff stress S follows the Green strain E = (C - I)/2 in a solid.
enum class SolidLaw {
  stvk,  ///< E . D E/2 with constant D
  /// mu/2 (tr C - 3) + lambda/4 (J^2 - 1) - (lambda/2 + mu) ln J (Simo and Taylor 1982); J^2 = det C is linear in C33,
  /// so that the energy is convex in an enhanced thickness strain. Infinite at collapse.
  neo_hookean,
};

/// Engineering constants of a ply: L along the fibres, T across them in the plane and through the thickness
/// (transversely isotropic where G_TT = E_T/(2 (1 + nu_TT))). Moduli in Pa; nu_LT is the contraction across per
/// stretch along.
struct PlyModuli {
  double e_l, e_t, g_lt, g_tt, nu_lt, nu_tt;
};

/// A law with its constants, in axes 1 (fibres), 2 and 3 (thickness).
struct SolidMaterial {
  SolidLaw law = SolidLaw::stvk;
  Elasticity elasticity = Elasticity::Zero();  ///< D at rest
  double lambda = 0, mu = 0;                   ///< Lame parameters of 3D elasticity, Pa; of neo_hookean only

  /// Young's modulus in Pa. Throws std::invalid_argument where the elasticity is not positive definite, as the other
  /// does.
  static SolidMaterial isotropic(SolidLaw law, double young_modulus, double poisson_ratio);
  /// St. Venant-Kirchhoff with fibres along axis 1.
  static SolidMaterial ply(const PlyModuli& moduli);
};

/// What a neo-Hookean solid says at one strain; `valid` where C = I + 2 E is positive definite.
struct NeoHookeanPoint {
  bool valid = false;
  double density = 0;  ///< J/m^3
  Voigt stress;        ///< Pa

  NeoHookeanPoint(const SolidMaterial& material, const Voigt& strain);
  /// dS/dE: lambda J^2 C^-1 (x) C^-1 + (2 mu - lambda (J^2 - 1)) C^-1 (.) C^-1. With `semidefinite` the second
  /// coefficient, which turns negative at large volumes, is at least zero.
  Elasticity tangent(bool semidefinite) const;

 private:
  double lambda_, mu_, growth_;  // growth: J^2 - 1
  Matrix3 inverse_;
};

}  // namespace taut
