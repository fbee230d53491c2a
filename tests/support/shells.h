#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/result.h"
#include "energies/prism_shell.h"
#include "geometry/grid.h"
#include "geometry/layered_mesh.h"

namespace taut {

/// A thick shell for static tests: its mesh, a material per layer, supports and nodal forces.
struct ShellCase {
  TriangleMesh mesh;
  LayeredMesh layered;
  std::vector<std::shared_ptr<const Energy>> energies;
  std::vector<bool> fixed;  ///< one per variable
  Vector forces;            ///< N, one per variable

  /// The mid-surface `mesh` with `thickness` and layers of these fractions.
  ShellCase(TriangleMesh mesh, double thickness, const std::vector<double>& fractions = {1.0});

  /// Between the two surfaces at half of `thickness` on either side of `mesh` along `normals`, one a vertex.
  ShellCase(TriangleMesh mesh, const std::vector<Vector3>& normals, double thickness);

  int vertices() const { return static_cast<int>(mesh.vertices.size()); }
  Vector rest() const;
  /// The material of one layer, or of all with -1.
  void set_material(int layer, const SolidMaterial& material, const PrismShellOptions& options,
                    const Vector3& fibres = Vector3::UnitX());
  /// Fixes one axis of all nodes of a vertex.
  void fix(int vertex, int axis);
  /// A force on a vertex, half of it on the bottom and half on the top.
  void add_force(int vertex, const Vector3& force);
  /// A force per area on each vertex by a third of the triangles around (mid-surface), on bottom and top.
  void add_surface_load(const Vector3& per_area);

  /// u with K u = forces, K the exact Hessian at rest.
  Vector linear_displacement() const;
  /// The lowest natural angular frequency, 1/s, by inverse iteration with the consistent mass; `density` in kg/m^3.
  double lowest_frequency(double density) const;
  /// Mean of a vertex's nodes in `values` (displacements or positions).
  Vector3 mean(int vertex, const Vector& values) const;
  /// Minimises the energies, and `more`, less forces . x from x by Newton's method until the largest nodal force is
  /// below `tolerance` N.
  Status minimise(Vector& x, double tolerance, const std::vector<const Energy*>& more = {}) const;

 private:
  std::vector<int> fixed_variables() const;
};

/// The unit square cut into a grid and mapped to a surface.
template <class Map>
TriangleMesh mapped_grid(int cells_x, int cells_y, Diagonals diagonals, const Map& map) {
  TriangleMesh mesh = make_grid(1, 1, cells_x, cells_y, diagonals);
  for (Vector3& v : mesh.vertices) v = map(v.x(), v.y());
  return mesh;
}

/// Prints "what: ours, reference, ratio" for the tables of the documentation, and expects the ratio within `tolerance`
/// of 1.
void expect_ratio(const std::string& what, double ours, double reference, double tolerance);

/// Six points of a prism: mid-points near a unit triangle, directors within `curvature` of its normal, turned in space.
std::array<Vector3, 6> random_prism(unsigned seed, double curvature);

}  // namespace taut
