#pragma once

#include "core/energy.h"
#include "linalg/svd3x2.h"

namespace taut {

/// Derivatives of an isotropic density psi(d1, d2) of the singular values of a 3x2 deformation gradient.
struct IsotropicDerivatives {
  double p1, p2;         ///< dpsi/dd1, dpsi/dd2
  double p11, p12, p22;  ///< second derivatives
  double flip;           ///< (p1 - p2)/(d1 - d2), in a form that is finite at d1 = d2
  double twist;          ///< (p1 + p2)/(d1 + d2)
  double out1, out2;     ///< p1/d1, p2/d2, in a form that is finite at 0
};

/// Node j of the triangle moves F by x_j (shape.row(j)): F = sum_j x_j shape_j, shape = A B of SL (20), 3x2.
using TriangleShape = Eigen::Matrix<double, 3, 2>;

/// d psi/dx = weight sum_k p_k (shape_j v_k) u_k (SL (27)), written to `gradient` (9 doubles).
void isotropic_gradient(const Svd32& svd, const TriangleShape& shape, double p1, double p2, double weight,
                        double* gradient);

/// The 9x9 Hessian of weight psi(F(x)) in its eigenframe: stretch pair (u1 v1^T, u2 v2^T), twist, flip and two
/// out-of-plane modes (derivatives of principal strains; [Smith et al. 2019]). positive_semidefinite clamps each mode,
/// and the 2x2 stretch block by its eigenvalues.
void isotropic_hessian(const Svd32& svd, const TriangleShape& shape, IsotropicDerivatives d, double weight,
                       Curvature curvature, double* hessian);

}  // namespace taut
