#include "linalg/isotropic_hessian.h"

#include <algorithm>

#include "linalg/symmetric2.h"

namespace taut {

void isotropic_gradient(const Svd32& svd, const TriangleShape& shape, double p1, double p2, double weight,
                        double* gradient) {
  const Vector3 b1 = shape * svd.v1, b2 = shape * svd.v2;
  Eigen::Map<Matrix3> g(gradient);
  for (int j = 0; j < 3; ++j) g.col(j) = (weight * p1 * b1[j]) * svd.u1 + (weight * p2 * b2[j]) * svd.u2;
}

void isotropic_hessian(const Svd32& svd, const TriangleShape& shape, IsotropicDerivatives d, double weight,
                       Curvature curvature, double* hessian) {
  if (curvature == Curvature::positive_semidefinite) {
    Matrix2 stretch;
    stretch << d.p11, d.p12, d.p12, d.p22;
    stretch = positive_part(stretch);
    d.p11 = stretch(0, 0);
    d.p12 = stretch(0, 1);
    d.p22 = stretch(1, 1);
    d.flip = std::max(d.flip, 0.0);
    d.twist = std::max(d.twist, 0.0);
    d.out1 = std::max(d.out1, 0.0);
    d.out2 = std::max(d.out2, 0.0);
  }
  const Vector3 b1 = shape * svd.v1, b2 = shape * svd.v2;
  // In the frame (u1, u2, n), node j contributes b1_j to column 1 and b2_j to column 2 of F.
  const double sum = 0.5 * weight * (d.flip + d.twist), difference = 0.5 * weight * (d.flip - d.twist);
  const double p11 = weight * d.p11, p12 = weight * d.p12, p22 = weight * d.p22, out1 = weight * d.out1,
               out2 = weight * d.out2;
  Eigen::Map<Eigen::Matrix<double, 9, 9>> h(hessian);
  for (int j = 0; j < 3; ++j) {
    for (int k = 0; k <= j; ++k) {
      const double b11 = b1[j] * b1[k], b12 = b1[j] * b2[k], b21 = b2[j] * b1[k], b22 = b2[j] * b2[k];
      Matrix3 block;
      block(0, 0) = p11 * b11 + sum * b22;
      block(0, 1) = p12 * b12 + difference * b21;
      block(1, 0) = p12 * b21 + difference * b12;
      block(1, 1) = p22 * b22 + sum * b11;
      block(2, 2) = out1 * b11 + out2 * b22;
      // frame * block * frame^T, with the zeros of `block` left out.
      const Vector3 left1 = block(0, 0) * svd.u1 + block(1, 0) * svd.u2,
                    left2 = block(0, 1) * svd.u1 + block(1, 1) * svd.u2;
      const Matrix3 world =
          left1 * svd.u1.transpose() + left2 * svd.u2.transpose() + (block(2, 2) * svd.n) * svd.n.transpose();
      h.block<3, 3>(3 * j, 3 * k) = world;
      if (k < j) h.block<3, 3>(3 * k, 3 * j) = world.transpose();
    }
  }
}

}  // namespace taut
