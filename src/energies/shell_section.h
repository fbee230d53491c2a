#pragma once

#include <vector>

#include "energies/prism_shell.h"
#include "geometry/triangle_mesh.h"

namespace taut {

/// Stress resultants of a shell, from second Piola-Kirchhoff stresses: per length and area at rest, in axes that turn
/// with the material.
struct Resultants {
  Vector3 n;  ///< N11, N22, N12: integrals of S through the thickness, N/m
  Vector3
      m;  ///< M11, M22, M12: of S z, z from the middle along the normal, N; M11 > 0 where the top is stretched along 1
  Vector2 q;  ///< Q1, Q2: of S13, S23, N/m
};

/// The state of one layer at a point.
struct LayerState {
  Voigt stress;       ///< second Piola-Kirchhoff, Pa, in the axes of the section
  Vector3 stretches;  ///< principal, the largest first
};

/// What a thick shell is like in the middle of each triangle, from all its layers.
///
/// Axes of a triangle: 3 is the normal of the mid-surface triangle at rest, 1 the shell's direction projected on its
/// plane (edge 1-2 where the direction is within a degree of the normal), 2 = 3 x 1.
class ShellSection {
 public:
  /// A layer and how many prisms it has through its thickness. The energy is borrowed: its prisms are those of all
  /// triangles in order, level after level.
  struct Layer {
    const PrismShell* energy;
    int prisms;
  };
  /// Layers from the bottom, and every prism of the shell at rest: triangle t of level l is l x triangles + t.
  ShellSection(std::vector<Layer> layers, const std::vector<Prism>& prisms, const std::vector<Vector3>& nodes,
               const Vector3& direction);

  int layers() const { return static_cast<int>(layers_.size()); }
  int triangles() const { return static_cast<int>(axes_.size()); }
  /// Area of the mid-surface triangle at rest, m^2.
  double area(int triangle) const { return areas_[static_cast<std::size_t>(triangle)]; }
  /// Axes of a triangle, one a column.
  const Matrix3& axes(int triangle) const { return axes_[static_cast<std::size_t>(triangle)]; }

  Resultants resultants(int triangle, const Vector& x) const;
  /// At the height `gamma` of a layer, -1 its bottom and 1 its top.
  LayerState state(int triangle, int layer, double gamma, const Vector& x) const;

 private:
  /// The prisms of one level.
  struct Level {
    const PrismShell* energy;
    int first;  // number of the prism of triangle 0 in the energy
  };
  PrismState state_at(int triangle, int level, double gamma, const Vector& x) const;
  Matrix3 stress_in_axes(int triangle, const PrismState& state) const;

  std::vector<Layer> layers_;
  std::vector<Level> levels_;
  std::vector<Matrix3> axes_;
  std::vector<double> areas_;
  std::vector<PrismShape> shapes_;  // level x triangles + triangle
  std::vector<Vector3> middles_;    // of the mid-surface triangles, m
};

}  // namespace taut
