#pragma once

#include "core/energy.h"
#include "energies/prism_kinematics.h"

namespace taut {

/// Turns the gradient in the GramStrain into one in the 18 surface coordinates.
void prism_gradient(const PrismVectors& v, const GramStrain& force, double* gradient);

/// Turns derivatives in the GramStrain into the 18 x 18 Hessian: the material part from `stiffness`, the geometric part
/// from `force`, which as a symmetric 5 x 5 matrix multiplies the identity of space. With positive_semidefinite that
/// matrix is replaced by its semidefinite part, after scaling edges and directors to their lengths at rest (`scale`:
/// the squares of two edges and of the directors, m^2).
void prism_hessian(const PrismVectors& v, const GramStrain& force, const GramStiffness& stiffness, const Vector3& scale,
                   Curvature curvature, double* hessian);

}  // namespace taut
