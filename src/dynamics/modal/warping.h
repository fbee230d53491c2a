#pragma once

#include "core/types.h"

namespace taut {

/// Modal warping [Choi and Ko 2005] at one node: linear displacement d = Phi q and rotation vector w = Psi q, half the
/// curl of the displacement field (MW (A.5)). The body turns from 0 to w while the deformation grows with it, so that
/// the node ends at the integral u = R~(w) d of the turned displacement along the ramp, not at R(w) d.

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// The rotation about w by |w|.
Matrix3 warp_rotation(const Vector3& w);

/// R~ = I + (1 - cos t)/t^2 [w]x + (t - sin t)/t^3 [w]x^2, t = |w|: the integral of warp_rotation(s w) over s in [0,
/// 1].
Matrix3 warp_integral(const Vector3& w);

/// d(R~(w) d)/dw.
Matrix3 warp_derivative(const Vector3& d, const Vector3& w);

/// Second derivatives of f . R~(w) d in (d, w).
Matrix6 warp_hessian(const Vector3& f, const Vector3& d, const Vector3& w);

}  // namespace taut
