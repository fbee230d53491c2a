#pragma once

#include <array>
#include <vector>

#include "core/energy.h"
#include "energies/prism_kinematics.h"

namespace taut {

struct PrismShellOptions {
  PrismElement element = PrismElement::assumed_strain;
  /// An extra thickness strain alpha gamma, alpha linear in the triangle, that minimises the energy of each element:
  /// the cure for Poisson thickness locking. Of assumed_strain only.
  bool enhanced_thickness = true;
  int points_in_plane = 3;      ///< 1, 3 or 6: exact for degree 1, 2, 4. One point leaves a mechanism.
  int points_in_thickness = 3;  ///< 2, 3 or 4 Gauss points: exact for strains of degree 1, 2, 3 in gamma of stvk
  /// Factor on the transverse shear stiffness of assumed_strain: 5/6 for one layer, which has constant shear where the
  /// exact one is a parabola; 1 where several layers follow the parabola.
  double shear_correction = 1;
  /// The same stiffness is multiplied by t^2/(t^2 + a h^2), h the longest edge (Lyly, Stenberg and Vihinen 1993):
  /// softer than exact on coarse meshes, exact as h -> 0. 0 for none.
  double shear_stabilisation = 0;

  /// Throws std::invalid_argument naming the field.
  void validate() const;
};

/// A prism at rest: indices of its nodes among the scene's, their positions, and axis 1 of its material (the fibres).
struct RestPrism {
  Prism nodes;
  std::array<Vector3, 6> points;
  Vector3 direction = Vector3::UnitX();
};

/// Rest prisms from nodes; `direction` as in RestPrism, `first_node` is added to the indices.
std::vector<RestPrism> rest_prisms(const std::vector<Prism>& prisms, const std::vector<Vector3>& nodes,
                                   const Vector3& direction = Vector3::UnitX(), int first_node = 0);

/// What a prism is like at one point, in the frame whose columns are its material axes at rest (axis 3 the normal of
/// its mid-surface triangle).
struct PrismState {
  Matrix3 frame;
  Voigt strain;  ///< Green strain, enhanced; transverse shear as the law sees it
  Voigt stress;  ///< second Piola-Kirchhoff, Pa; shear stresses work on the strains before the shear correction
};

/// Elastic energy of six-node prisms of one material, the layer of a shell: 18 variables, y1 ... y6 of MLTS (22). The
/// energy of an element is a function of its GramStrain, which the quadrature and the enhanced strains turn into: one
/// quadratic form (stvk), or a sum over points (neo_hookean).
///
/// The positive semidefinite form takes the material's stiffness, which is, and the semidefinite part of the geometric
/// one, a 5 x 5 matrix for all three coordinates: it is nowhere below the exact form.
class PrismShell final : public Energy {
 public:
  /// Throws std::invalid_argument where a prism is inverted at rest.
  PrismShell(std::string name, const std::vector<RestPrism>& prisms, const SolidMaterial& material,
             const PrismShellOptions& options);

  std::string name() const override { return name_; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;
  /// Neo-Hookean elements keep det F positive at their quadrature points.
  bool guards_steps() const override { return material_.law == SolidLaw::neo_hookean; }
  double largest_step(Index element, const double* x, const double* dx) const override;

  /// Strain and stress at barycentric coordinates `l` and gamma, with the enhanced strain of the column of points at
  /// `l`. NaN where a neo-Hookean element has collapsed.
  PrismState state(Index element, const double* x, const Vector3& l, double gamma) const;

 private:
  /// A quadrature point: strains, volume (m^3), and enhanced thickness strain E33 per alpha.
  struct Point {
    StrainMatrix strain;
    double volume, enhancement;
  };
  /// Energy and its derivatives with respect to the GramStrain.
  struct Response {
    double value = 0;
    GramStrain force = GramStrain::Zero();
    GramStiffness stiffness = GramStiffness::Zero();
  };
  enum class Wanted { value, force, stiffness };
  /// A GramStiffness by the ten 4 x 4 blocks of its lower triangle, row after row: an evaluation is bound by the memory
  /// it reads.
  using PackedStiffness = std::array<double, 160>;

  /// Where a point is, and what all prisms have in common there.
  struct Place {
    Vector3 l;
    double gamma, weight;
    StrainMatrix covariant;
  };

  Place place_at(const Vector3& l, double gamma, double weight) const {
    return {l, gamma, weight, covariant_strain(options_.element, l, gamma)};
  }
  Point point_at(const PrismKinematics& kinematics, const Place& place) const;
  std::vector<Point> column_at(const PrismKinematics& kinematics, const Vector3& l, double weight) const;
  /// The alpha of a column whose strains without it are `strains`.
  double enhanced_strain(const Point* column, const Voigt* strains) const;
  GramStiffness constant_stiffness(const Point* points) const;
  static PackedStiffness packed(const GramStiffness& stiffness);
  static GramStiffness unpacked(const PackedStiffness& stiffness);
  static GramStrain product(const PackedStiffness& stiffness, const GramStrain& strain);
  bool add_neo_hookean_column(const Point* column, const GramStrain& strain, Wanted wanted, Curvature curvature,
                              Response& response) const;

  std::string name_;
  SolidMaterial material_;
  PrismShellOptions options_;
  Stencils stencils_{18};
  std::vector<PrismKinematics> kinematics_;
  std::vector<GramStrain> rest_;            // one an element
  std::vector<Vector3> scale_;              // squared lengths of edges and directors at rest, m^2
  std::vector<PackedStiffness> stiffness_;  // stvk: one an element
  std::vector<Point> points_;               // neo_hookean: columns of points_in_thickness, points_in_plane an element
};

}  // namespace taut
