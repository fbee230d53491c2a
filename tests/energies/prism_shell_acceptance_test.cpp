// Benchmarks of thick shells: the numbers of docs/theory/prism_shell.md.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/stopwatch.h"
#include "support/meshes.h"
#include "support/shells.h"

namespace taut {
namespace {

constexpr double pi = std::numbers::pi;

enum class Edges { hard, clamped };
enum class Cure { none, shear_only, all };

PrismShellOptions options_of(Cure cure) {
  PrismShellOptions options;
  options.shear_correction = 5.0 / 6;
  if (cure == Cure::none) options.element = PrismElement::plain;
  if (cure == Cure::shear_only) options.enhanced_thickness = false;
  return options;
}

/// A quarter of a square plate of side 1 with symmetry at x = 1/2 and y = 1/2: supports on x = 0 and y = 0.
struct QuarterPlate : ShellCase {
  QuarterPlate(int cells, double thickness, Edges edges, Diagonals diagonals = Diagonals::right,
               const std::vector<double>& fractions = {1.0})
      : ShellCase(make_grid(0.5, 0.5, cells, cells, diagonals), thickness, fractions) {
    for (int v = 0; v < vertices(); ++v) {
      const Vector3& p = mesh.vertices[v];
      if (p.x() == 0.5) fix(v, 0);
      if (p.y() == 0.5) {
        fix(v, 1);
        if (p.x() == 0.5) centre = v;
      }
      if (p.x() != 0 && p.y() != 0) continue;
      fix(v, 2);
      if (edges == Edges::clamped || p.x() == 0) fix(v, 1);
      if (edges == Edges::clamped || p.y() == 0) fix(v, 0);
    }
  }
  double deflection() const { return mean(centre, linear_displacement()).z(); }
  int centre = -1;
};

/// w D/(q a^4) at the centre under a uniform load.
double uniform_plate(int cells, double thickness, double ratio, Edges edges, const PrismShellOptions& options,
                     Diagonals diagonals = Diagonals::right) {
  QuarterPlate plate(cells, thickness, edges, diagonals);
  plate.set_material(-1, SolidMaterial::isotropic(SolidLaw::stvk, 1, ratio), options);
  plate.add_surface_load({0, 0, 1});
  return plate.deflection() * std::pow(thickness, 3) / (12 * (1 - ratio * ratio));
}

void report(const std::string& what, double ours, double reference) {
  std::printf("%-60s ours %.6g reference %.6g ratio %.5f\n", what.c_str(), ours, reference, ours / reference);
}


/// A grid of [0, 1] x [0, 1] mapped to a surface.
template <class Map>
TriangleMesh mapped_grid(int cells_x, int cells_y, Diagonals diagonals, const Map& map) {
  TriangleMesh mesh = make_grid(1, 1, cells_x, cells_y, diagonals);
  for (Vector3& v : mesh.vertices) v = map(v.x(), v.y());
  mesh.corner_uv.clear();
  return mesh;
}

/// The vertical deflection of the middle of a free edge.
double scordelis_lo(int cells, const PrismShellOptions& options, Diagonals diagonals) {
  constexpr double radius = 25, half_length = 25, half_angle = 40 * pi / 180;
  TriangleMesh mesh = make_grid(1, 1, cells, cells, diagonals);
  std::vector<Vector3> normals;
  const TriangleMesh flat = mesh;
  for (Vector3& v : mesh.vertices) {
    const double angle = half_angle * v.y();
    normals.emplace_back(0, std::sin(angle), std::cos(angle));
    v = half_length * v.x() * Vector3::UnitX() + radius * normals.back();
  }
  ShellCase roof(mesh, normals, 0.25);
  roof.set_material(-1, SolidMaterial::isotropic(SolidLaw::stvk, 4.32e8, 0), options);
  int corner = -1;
  for (int v = 0; v < roof.vertices(); ++v) {
    const Vector3& p = flat.vertices[v];
    if (p.x() == 0) roof.fix(v, 1);
    if (p.x() == 0) roof.fix(v, 2);
    if (p.x() == 1) roof.fix(v, 0);
    if (p.y() == 0) roof.fix(v, 1);
    if (p.x() == 1 && p.y() == 1) corner = v;
  }
  roof.add_surface_load({0, 0, -90});
  return -roof.mean(corner, roof.linear_displacement()).z();
}

/// The vertical displacement of the middle of the loaded edge.
double cook(int cells, double ratio, const PrismShellOptions& options, Diagonals diagonals) {
  ShellCase membrane(mapped_grid(cells, cells, diagonals,
                                 [](double x, double y) {
                                   return Vector3(48 * x, 44 * x + y * (44 + (16 - 44) * x), 0);
                                 }),
                     1.0);
  membrane.set_material(-1, SolidMaterial::isotropic(SolidLaw::stvk, 1, ratio), options);
  int middle = -1;
  for (int v = 0; v < membrane.vertices(); ++v) {
    const Vector3& p = membrane.mesh.vertices[v];
    membrane.fixed[3 * membrane.layered.node(v, 0) + 2] = true;
    if (p.x() == 0) membrane.fix(v, 0);
    if (p.x() == 0) membrane.fix(v, 1);
    if (p.x() != 48) continue;
    membrane.add_force(v, {0, (p.y() < 44.001 || p.y() > 59.999 ? 0.5 : 1.0) / cells, 0});
    if (std::abs(p.y() - 52) < 1e-9) middle = v;
  }
  return membrane.mean(middle, membrane.linear_displacement()).y();
}

double pagano(int cells, double slenderness, int per_ply, Diagonals diagonals, const PrismShellOptions& options) {
  std::vector<double> fractions(3 * per_ply, 1.0 / (3 * per_ply));
  QuarterPlate plate(cells, 1 / slenderness, Edges::hard, diagonals, fractions);
  const SolidMaterial ply = SolidMaterial::ply({25, 1, 0.5, 0.2, 0.25, 0.25});
  for (int layer = 0; layer < 3 * per_ply; ++layer) {
    plate.set_material(layer, ply, options, layer / per_ply == 1 ? Vector3::UnitY() : Vector3::UnitX());
  }
  for (const Triangle& t : plate.mesh.triangles) {
    const Vector3 a = plate.mesh.vertices[t[1]] - plate.mesh.vertices[t[0]], b = plate.mesh.vertices[t[2]] - plate.mesh.vertices[t[0]];
    for (int v : t) {
      const Vector3& p = plate.mesh.vertices[v];
      plate.forces[3 * plate.layered.node(v, 3 * per_ply) + 2] += std::sin(pi * p.x()) * std::sin(pi * p.y()) * a.cross(b).norm() / 6;
    }
  }
  const Vector u = plate.linear_displacement();
  const int level = (3 * per_ply) / 2;
  const double w = 0.5 * (u[3 * plate.layered.node(plate.centre, level) + 2] + u[3 * plate.layered.node(plate.centre, level + 1) + 2]);
  return 100 * std::pow(1 / slenderness, 3) * w;
}

TEST(Explore, Membranes) {
  for (auto d : {Diagonals::right, Diagonals::left, Diagonals::alternating, Diagonals::union_jack}) {
    for (int cells : {16, 32, 64}) {
      const std::string label = " cells " + std::to_string(cells) + " diag " + std::to_string(int(d));
      report("scordelis" + label, scordelis_lo(cells, options_of(Cure::all), d), 0.30147497);
      auto o = options_of(Cure::all); o.shear_stabilisation = .1;
      report("scordelis stab" + label, scordelis_lo(cells, o, d), 0.30147497);
      report("cook 1/3" + label, cook(cells, 1.0/3, {}, d), 23.9677);
      report("cook .49 (ratio to 1/3 ref)" + label, cook(cells, 0.49, {}, d), 23.9677);
      o.element = PrismElement::plain;
      report("cook plain 1/3" + label, cook(cells, 1.0/3, o, d), 23.9677);
    }
  }
}
TEST(Explore, Pagano) {
  for (auto d : {Diagonals::alternating, Diagonals::union_jack}) 
    for (int cells : {16, 32}) for (int per : {1, 3}) {
      const std::string label = " cells " + std::to_string(cells) + " diag " + std::to_string(int(d)) + " per ply " + std::to_string(per);
      report("S=4" + label, pagano(cells, 4, per, d, {}), 2.0059105305461307);
      report("S=10" + label, pagano(cells, 10, per, d, {}), 0.7530300429170742);
      report("S=100" + label, pagano(cells, 100, per, d, {}), 0.434721971815227);
    }
}
TEST(Explore, PlateNu) {
  for (double nu : {0., .3, .45, .49}) for (double t : {.1, .01, .001}) for (auto d : {Diagonals::alternating, Diagonals::union_jack}) {
    const double k = 0.004062352660696519;
    const std::string label = " nu " + std::to_string(nu) + " t " + std::to_string(t)+ " diag " + std::to_string(int(d));
    report("uncured vs Kirchhoff" + label, uniform_plate(32, t, nu, Edges::hard, options_of(Cure::shear_only), d), k);
    report("plain vs Kirchhoff" + label, uniform_plate(32, t, nu, Edges::hard, options_of(Cure::none), d), k);
    report("cured vs Kirchhoff" + label, uniform_plate(32, t, nu, Edges::hard, options_of(Cure::all), d), k);
    report("cured C vs Kirchhoff" + label, uniform_plate(32, t, nu, Edges::clamped, options_of(Cure::all), d), 0.0012653190875273068);
  }
}
}  // namespace
}  // namespace taut
