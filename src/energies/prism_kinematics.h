#pragma once

#include "energies/solid_law.h"
#include "geometry/prism.h"

namespace taut {

/// Which strains a prism has.
enum class PrismElement {
  plain,           ///< those of the isoparametric map (MLTS (1)-(3)): locks when thin, and when nu > 0 in bending
  assumed_strain,  ///< transverse shear tied at mid-edges (MITC3), thickness strain tied at the vertices
};

/// The five vectors that a prism's strains depend on: x2 - x1, x3 - x1, n1, n2, n3, one per column, m.
using PrismVectors = Eigen::Matrix<double, 3, 5>;
/// Changes of their 15 inner products, one per pair: (|v_k|^2 - |V_k|^2)/2 and v_k . v_l - V_k . V_l, m^2. Every strain
/// of either element is linear in them, so they are strains that know nothing of rigid motions. The 16th entry is zero
/// and keeps columns aligned.
using GramStrain = Eigen::Matrix<double, 16, 1>;
/// Second derivatives of an energy with respect to a GramStrain.
using GramStiffness = Eigen::Matrix<double, 16, 16>;
/// One column per strain in Voigt's order: strain = matrix^T x GramStrain.
using StrainMatrix = Eigen::Matrix<double, 16, 6>;

/// Place of the pair (k, l) in a GramStrain.
constexpr int gram_pair(int k, int l) {
  const int low = k < l ? k : l, high = k < l ? l : k;
  return low * (9 - low) / 2 + high;
}

/// The vectors of surface nodes y1 ... y6 (18 coordinates; MLTS (22)).
PrismVectors prism_vectors(const double* y);
/// Inner products in the places of GramStrain, those of a vector with itself halved.
GramStrain gram(const PrismVectors& v);

/// Covariant strains 11, 22, 33, 2x12, 2x13, 2x23 in the coordinates (L2, L3, gamma) at barycentric coordinates L and
/// gamma: the same for all prisms, as linear functions of the GramStrain.
StrainMatrix covariant_strain(PrismElement element, const Vector3& l, double gamma);

/// Strains of one prism in the frame of its mid-surface triangle: axis 3 is the triangle's normal at rest, axis 1 a
/// given direction projected on its plane.
class PrismKinematics {
 public:
  /// `direction`: axis 1; where it is within a degree of the normal, edge 1-2 serves. `shear_factor` scales transverse
  /// shear stiffness, and so its root the strains.
  PrismKinematics(const PrismShape& rest, const Vector3& direction, PrismElement element, double shear_factor);

  /// Green strain at barycentric coordinates L and gamma as a linear function of the GramStrain.
  StrainMatrix strain(const Vector3& l, double gamma) const {
    return strain(covariant_strain(element_, l, gamma), l, gamma);
  }
  /// The same from covariant_strain() there.
  StrainMatrix strain(const StrainMatrix& covariant, const Vector3& l, double gamma) const;
  /// dX/dq of MLTS (2) in the frame, m.
  Matrix3 jacobian(const Vector3& l, double gamma) const;
  /// The frame's axes, one per column.
  const Matrix3& frame() const { return frame_; }
  double shear_scale() const { return shear_scale_; }
  GramStrain rest_gram() const { return gram(rest_); }

 private:
  PrismVectors rest_;
  Matrix3 frame_;
  PrismElement element_;
  double shear_scale_;
};

/// Coefficients of g_1, g_2, g_3 (the columns of MLTS (3)) in the five vectors.
using TangentCoefficients = Eigen::Matrix<double, 5, 3>;
TangentCoefficients tangents(const Vector3& l, double gamma);

}  // namespace taut
