#pragma GCC diagnostic ignored "-Wunused-function"
// Benchmarks of thick shells: the numbers of docs/theory/prism_shell.md.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "core/stopwatch.h"
#include "energies/end_moment.h"
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


/// A strip along x clamped at x = 0, one cell wide.
struct Cantilever : ShellCase {
  Cantilever(double length, double width, double thickness, int cells, Diagonals diagonals)
      : ShellCase(make_grid(length, width, cells, 1, diagonals), thickness) {
    for (int v = 0; v < vertices(); ++v) {
      const double at = mesh.vertices[v].x();
      for (int axis = 0; axis < 3 && at == 0; ++axis) fix(v, axis);
      fix(v, 1);
      if (at == length) tip.push_back(v);
    }
  }
  std::vector<int> tip;
};

void roll_up(double slenderness, SolidLaw law, int cells, Diagonals d, int steps) {
  const double length = 10, t = length / slenderness, young = 12 / (t*t*t);
  Cantilever strip(length, 1, t, cells, d);
  strip.set_material(-1, SolidMaterial::isotropic(law, young, 0), options_of(Cure::all));
  Vector x = strip.rest();
  std::vector<EndMoment::Load> loads;
  const double moment = 2 * pi / length;  // EI = 1
  for (int v : strip.tip) loads.push_back({strip.layered.node(v, 0), strip.layered.node(v, 1), moment / 2});
  EndMoment end("end", loads, Vector3(0, -1, 0), x);
  for (int step = 1; step <= steps; ++step) {
    end.set_factor(double(step) / steps);
    Status st = strip.minimise(x, 1e-6 * moment, {&end});
    end.set_reference(x);
    if (step % (steps/4) == 0 || st != Status::solved) {
      const double m = 2 * pi * step / steps;
      Vector3 tip = 0.5 * (strip.mean(strip.tip[0], x) + strip.mean(strip.tip[1], x));
      printf("L/t %g law %d cells %d diag %d: load %g status %s U/L %.5f (%.5f) W/L %.5f (%.5f) y %.5f\n", slenderness, int(law), cells, int(d), double(step) / steps, to_string(st).data(),
        1 - tip.x() / length, 1 - std::sin(m) / m, tip.z() / length, (1 - std::cos(m)) / m, tip.y());
      if (st != Status::solved) break;
    }
  }
}
TEST(Explore, RollUp) {
  for (double s : {1000.}) for (auto law : {SolidLaw::stvk, SolidLaw::neo_hookean}) for (auto d : {Diagonals::right, Diagonals::alternating, Diagonals::union_jack}) { roll_up(s, law, 40, d, 20); }
}
TEST(Explore, Elastica) {
  for (double s : {10., 100., 1000.}) for (auto d : {Diagonals::alternating, Diagonals::union_jack}) {
    const double length = 10, t = length / s, young = 12 / (t*t*t);
    Cantilever strip(length, 1, t, 40, d);
    strip.set_material(-1, SolidMaterial::isotropic(SolidLaw::stvk, young, 0), options_of(Cure::all));
    Vector x = strip.rest();
    double alphas[] = {1, 2, 4, 10}, vert[] = {0.301720774, 0.493457480, 0.669964181, 0.810609025}, shor[] = {0.056433236, 0.160641721, 0.328941242, 0.554995598};
    double last = 0;
    for (int i = 0; i < 4; ++i) {
      Status st;
      for (int k = 1; k <= 4; ++k) {
        strip.forces.setZero();
        for (int v : strip.tip) strip.add_force(v, {0, 0, (last + (alphas[i] - last) * k / 4) / 100 / 2});
        st = strip.minimise(x, 1e-6);
      }
      last = alphas[i];
      Vector3 tip = 0.5 * (strip.mean(strip.tip[0], x) + strip.mean(strip.tip[1], x));
      printf("elastica L/t %g diag %d alpha %g status %s w/L %.5f (%.5f) short %.5f (%.5f)\n", s, int(d), alphas[i], to_string(st).data(), tip.z()/length, vert[i], 1 - tip.x()/length, shor[i]);
    }
  }
}
void annular(int radial, int around, Diagonals d, int steps, double stab) {
 auto o = options_of(Cure::all); o.shear_stabilisation = stab;
  ShellCase plate(mapped_grid(around, radial, d, [](double x, double y) { const double a = 2 * pi * x, r = 6 + 4 * y; return Vector3(r * std::cos(a), -r * std::sin(a), 0); }), .03);
  for (auto& t : plate.mesh.triangles) (void)t;
  plate.set_material(-1, SolidMaterial::isotropic(SolidLaw::stvk, 21e6, 0), o);
  std::vector<int> edge; int a = -1, b = -1;
  for (int v = 0; v < plate.vertices(); ++v) {
    const int i = v % (around + 1), j = v / (around + 1);
    if (v >= (around + 1) * (radial + 1)) continue;
    if (i == 0) { edge.push_back(v); if (j == 0) a = v; if (j == radial) b = v; }
    if (i == around) for (int axis = 0; axis < 3; ++axis) plate.fix(v, axis);
  }
  Vector x = plate.rest();
  for (int step = 1; step <= steps; ++step) {
    plate.forces.setZero();
    for (int v : edge) plate.add_force(v, {0, 0, 0.8 * step / steps * (4. / radial) * (v == a || v == b ? .5 : 1)});
    const auto t0 = std::chrono::steady_clock::now();
    Status st = plate.minimise(x, 3e-5);
    printf("annular %dx%d stab %g diag %d load %g status %s WA %.3f WB %.3f  (%.1f s)\n", radial, around, stab, int(d), double(step)/steps, to_string(st).data(), plate.mean(a, x).z(), plate.mean(b, x).z(), std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count());
    if (st != Status::solved) break;
  }
}
TEST(Explore, Annular) {
  annular(16, 64, Diagonals::alternating, 5, 0);
  annular(16, 64, Diagonals::alternating, 5, 0.1);
  annular(16, 64, Diagonals::right, 5, 0);
  annular(16, 64, Diagonals::left, 5, 0);
  annular(16, 64, Diagonals::union_jack, 5, 0);
  annular(32, 64, Diagonals::alternating, 5, 0);
}
}
}
