#include "energies/prism_assembly.h"

#include <Eigen/Eigenvalues>

namespace taut {
namespace {

using Matrix5 = Eigen::Matrix<double, 5, 5>;
using Matrix15 = Eigen::Matrix<double, 15, 15>;

/// The force as the symmetric matrix S with dW = sum_kl S_kl v_l . dv_k.
Matrix5 symmetric(const GramStrain& force) {
  Matrix5 s;
  for (int k = 0; k < 5; ++k) {
    for (int l = 0; l < 5; ++l) s(k, l) = force[gram_pair(k, l)];
  }
  return s;
}

Matrix5 semidefinite_part(const Matrix5& s, const Vector3& scale) {
  Eigen::Matrix<double, 5, 1> length;
  length << scale[0], scale[1], Vector3::Constant(scale[2]);
  length = length.cwiseSqrt().eval();
  const Matrix5 scaled = length.asDiagonal() * s * length.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix5> eigen(scaled);
  if (eigen.eigenvalues()[0] >= 0) return s;
  const Matrix5 vectors = length.cwiseInverse().asDiagonal() * eigen.eigenvectors();
  return vectors * eigen.eigenvalues().cwiseMax(0).asDiagonal() * vectors.transpose();
}

/// Adds columns of derivatives in the five vectors up to derivatives in the nodes (MLTS (22)): row blocks a1, a2, n1,
/// n2, n3 of `from` become y1 ... y6 of `to`.
template <class From, class To>
void to_nodes(const From& from, To& to) {
  const auto a1 = from.template middleRows<3>(0), a2 = from.template middleRows<3>(3);
  for (int j = 0; j < 3; ++j) {
    const auto n = from.template middleRows<3>(6 + 3 * j);
    auto bottom = to.template middleRows<3>(6 * j), top = to.template middleRows<3>(6 * j + 3);
    if (j == 0) {
      bottom = -0.5 * (a1 + a2 + n);
      top = -0.5 * (a1 + a2 - n);
    } else {
      bottom = 0.5 * ((j == 1 ? a1 : a2) - n);
      top = 0.5 * ((j == 1 ? a1 : a2) + n);
    }
  }
}

/// Columns (3 k + c) of the result, which has one more to be square: sum_l v_l[c] column gram_pair(k, l) of `matrix`.
GramStiffness times_strain_derivative(const GramStiffness& matrix, const PrismVectors& v) {
  GramStiffness product;
  product.col(15).setZero();
  for (int k = 0; k < 5; ++k) {
    for (int c = 0; c < 3; ++c) {
      product.col(3 * k + c) = v(c, 0) * matrix.col(gram_pair(k, 0)) + v(c, 1) * matrix.col(gram_pair(k, 1)) +
                               v(c, 2) * matrix.col(gram_pair(k, 2)) + v(c, 3) * matrix.col(gram_pair(k, 3)) +
                               v(c, 4) * matrix.col(gram_pair(k, 4));
    }
  }
  return product;
}

}  // namespace

void prism_gradient(const PrismVectors& v, const GramStrain& force, double* gradient) {
  const PrismVectors g = v * symmetric(force);
  const Eigen::Map<const Eigen::Matrix<double, 15, 1>> stacked(g.data());
  Eigen::Map<Eigen::Matrix<double, 18, 1>> out(gradient);
  to_nodes(stacked, out);
}

void prism_hessian(const PrismVectors& v, const GramStrain& force, const GramStiffness& stiffness, const Vector3& scale,
                   Curvature curvature, double* hessian) {
  const GramStiffness turned_once = times_strain_derivative(stiffness, v).transpose();
  Matrix15 h = times_strain_derivative(turned_once, v).topLeftCorner<15, 15>();
  Matrix5 s = symmetric(force);
  if (curvature == Curvature::positive_semidefinite) s = semidefinite_part(s, scale);
  for (int k = 0; k < 5; ++k) {
    for (int l = 0; l < 5; ++l) {
      for (int c = 0; c < 3; ++c) h(3 * k + c, 3 * l + c) += s(k, l);
    }
  }
  // h is symmetric up to round-off; one triangle decides.
  h.triangularView<Eigen::StrictlyUpper>() = h.transpose();
  Eigen::Matrix<double, 18, 15> half;
  to_nodes(h, half);
  const Eigen::Matrix<double, 15, 18> turned = half.transpose();
  Eigen::Map<Eigen::Matrix<double, 18, 18>> out(hessian);
  to_nodes(turned, out);
}

}  // namespace taut
