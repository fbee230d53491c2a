#pragma once

#include <vector>

#include "core/energy.h"
#include "energies/inertia.h"
#include "geometry/tetrahedra.h"

namespace taut {

/// Linear elasticity of four-node tetrahedra about their rest positions: V (lambda/2 (tr e)^2 + mu e : e), e the
/// symmetric part of the displacement gradient. It does not know rotations: its Hessian is what it is for (modes). The
/// element locks in bending: several layers of cells through a thin part still leave it too stiff.
class LinearTetrahedra final : public Energy {
 public:
  /// `young_modulus` in Pa.
  LinearTetrahedra(std::string name, const TetrahedronMesh& mesh, double young_modulus, double poisson_ratio);

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;

 private:
  using Local = Eigen::Matrix<double, 12, 1>;
  using Stiffness = Eigen::Matrix<double, 12, 12>;

  std::string name_;
  Stencils stencils_{12};
  std::vector<Local> rest_;
  std::vector<Stiffness> stiffness_;
};

/// Consistent masses, or a quarter of each cell's at its corners.
Inertia tetrahedron_inertia(std::string name, const TetrahedronMesh& mesh, double density, bool lumped);

}  // namespace taut
