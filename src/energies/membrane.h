#pragma once

#include <vector>

#include "core/energy.h"
#include "geometry/rest_shape.h"

namespace taut {

/// How stress follows stretch in the plane of the membrane.
enum class MembraneLaw {
  stvk,         ///< mu tr(E^2) + lambda/2 tr(E)^2 on the Green strain E = (F^T F - I)/2
  neo_hookean,  ///< mu/2 (tr C - 2 - 2 ln J) + lambda/2 (ln J)^2, J = d1 d2; infinite at collapse
};

/// Plane-stress Lame parameters, Pa: lambda = E nu/(1 - nu^2), mu = E/(2 (1 + nu)). Both laws share them, so both
/// agree with plane-stress linear elasticity to first order.
struct Lame {
  double lambda, mu;
  static Lame plane_stress(double young_modulus, double poisson_ratio);
};

/// Stretching energy of linear triangles: thickness times rest area times the density of the law.
class Membrane final : public Energy {
 public:
  /// `thickness` in m.
  Membrane(std::string name, std::vector<RestTriangle> triangles, MembraneLaw law, Lame lame, double thickness);

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;
  bool takes_four(Curvature /*curvature*/) const override { return law_ == MembraneLaw::stvk; }
  Pack evaluate_four(Index quad, const Pack* x, Pack* gradient, Pack* hessian, Curvature curvature) const override;
  bool guards_steps() const override { return law_ == MembraneLaw::neo_hookean; }
  double largest_step(Index element, const double* x, const double* dx) const override;
  const std::vector<RestTriangle>& triangles() const { return triangles_; }
  MembraneLaw law() const { return law_; }
  Lame lame() const { return lame_; }
  double thickness() const { return thickness_; }

 private:
  template <class Real, class Shape>
  Real evaluate_stvk(const Shape& shape, Real weight, const Real* x, Real* gradient, Real* hessian,
                     Curvature curvature) const;
  double evaluate_neo_hookean(const RestTriangle& triangle, const double* x, double* gradient, double* hessian,
                              Curvature curvature) const;

  std::string name_;
  std::vector<RestTriangle> triangles_;
  std::vector<RestQuad> quads_;  // with the St. Venant-Kirchhoff law
  MembraneLaw law_;
  Lame lame_;
  double thickness_;
  Stencils stencils_{9};
};

}  // namespace taut
