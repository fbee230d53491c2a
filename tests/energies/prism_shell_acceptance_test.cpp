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

TEST(Explore, Plates) {
  for (int cells : {8, 16, 32}) for (double t : {0.1, 0.01, 0.001}) {
    const double reference = t == 0.1 ? 0.004272842263261955 : t == 0.01 ? 0.004064457559984216 : 0.004062373717359586;
    const double clamped = t == 0.1 ? 0.0015046256115096752 : t == 0.01 ? 0.0012678566805676046 : 0.00126534450330926;
    const std::string label = "cells " + std::to_string(cells) + " t " + std::to_string(t);
    report("plain SS " + label, uniform_plate(cells, t, .3, Edges::hard, options_of(Cure::none)), reference);
    report("shear only SS " + label, uniform_plate(cells, t, .3, Edges::hard, options_of(Cure::shear_only)), reference);
    report("cured SS " + label, uniform_plate(cells, t, .3, Edges::hard, options_of(Cure::all)), reference);
    for (auto d : {Diagonals::right, Diagonals::left, Diagonals::alternating, Diagonals::union_jack}) {
      report("cured C " + label + " diag " + std::to_string(int(d)), uniform_plate(cells, t, .3, Edges::clamped, options_of(Cure::all), d), clamped);
      auto o = options_of(Cure::all); o.shear_stabilisation = .1;
      report("cured C stab .1" + label + " diag " + std::to_string(int(d)), uniform_plate(cells, t, .3, Edges::clamped, o, d), clamped);
    }
  }
}

}  // namespace
}  // namespace taut
