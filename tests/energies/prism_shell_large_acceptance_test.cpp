// Large-deflection benchmarks of thick shells; they print case, ours, reference, ratio (docs/theory/prism_shell.md).

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "energies/end_moment.h"
#include "support/meshes.h"
#include "support/shells.h"
#include "support/stvk_beam.h"

namespace taut {
namespace {

constexpr double pi = std::numbers::pi, length = 10;

/// A strip along x of 40 cells, clamped at x = 0 and kept from moving along y, with EI = 1 and nu = 0.
struct Cantilever : ShellCase {
  Cantilever(double slenderness, SolidLaw law)
      : ShellCase(make_grid(length, 1, 40, 1, Diagonals::alternating), length / slenderness),
        thickness(length / slenderness),
        young(12 / std::pow(thickness, 3)) {
    PrismShellOptions options;
    options.shear_correction = 5.0 / 6;
    set_material(-1, SolidMaterial::isotropic(law, young, 0), options);
    for (int v = 0; v < vertices(); ++v) {
      const double at = mesh.vertices[v].x();
      for (int axis = 0; axis < 3 && at == 0; ++axis) fix(v, axis);
      fix(v, 1);
      if (at == length) tip.push_back(v);
    }
  }
  /// Forward and upward position of the tip over the length.
  Vector2 tip_of(const Vector& x) const {
    const Vector3 p = 0.5 * (mean(tip[0], x) + mean(tip[1], x)) / length;
    return {p.x(), p.z()};
  }
  double thickness, young;
  std::vector<int> tip;
};

/// The tip after each of `steps` equal steps to the moment that rolls a beam up to a full circle.
std::vector<Vector2> roll_up(double slenderness, SolidLaw law, int steps) {
  Cantilever strip(slenderness, law);
  const double moment = 2 * pi / length;
  Vector x = strip.rest();
  std::vector<EndMoment::Load> loads;
  for (int v : strip.tip) loads.push_back({strip.layered.node(v, 0), strip.layered.node(v, 1), moment / 2});
  EndMoment end("end", loads, -Vector3::UnitY(), x);
  std::vector<Vector2> path;
  for (int step = 1; step <= steps; ++step) {
    end.set_factor(static_cast<double>(step) / 20);
    EXPECT_EQ(strip.minimise(x, 1e-6 * moment, {&end}), Status::solved) << "step " << step;
    end.set_reference(x);
    path.push_back(strip.tip_of(x));
  }
  return path;
}

void expect_tip(const std::string& what, const Vector2& ours, const Vector2& reference, double tolerance) {
  std::printf("%-50s ours (%8.5f, %8.5f) reference (%8.5f, %8.5f) distance %.5f\n", what.c_str(), ours.x(), ours.y(),
              reference.x(), reference.y(), (ours - reference).norm());
  EXPECT_LE((ours - reference).norm(), tolerance) << what;
}

TEST(PrismShellRollUp, OfAThinStripIsTheCircleWithinHalfAPercentOfTheLength) {
  for (SolidLaw law : {SolidLaw::stvk, SolidLaw::neo_hookean}) {
    const std::vector<Vector2> path = roll_up(1000, law, 20);
    for (int quarter = 1; quarter <= 4; ++quarter) {
      const double turn = pi / 2 * quarter;
      expect_tip("roll-up, L/t 1000, load " + std::to_string(0.25 * quarter).substr(0, 4), path[5 * quarter - 1],
                 {std::sin(turn) / turn, (1 - std::cos(turn)) / turn}, 5e-3);
    }
  }
}

// St. Venant-Kirchhoff material is softer in bending than EI says, visibly so from L/t = 100 downwards.
TEST(PrismShellRollUp, OfThickerStripsFollowsTheBendingLawOfStVenantKirchhoff) {
  for (double slenderness : {10.0, 20.0, 100.0}) {
    const int quarters = slenderness == 10 ? 3 : 4;
    const std::vector<Vector2> path = roll_up(slenderness, SolidLaw::stvk, 5 * quarters);
    const Cantilever strip(slenderness, SolidLaw::stvk);
    const StvkBeam beam{strip.young, strip.thickness, 5.0 / 6, length};
    for (int quarter = 1; quarter <= quarters; ++quarter) {
      const double turn = pi / 2 * quarter;
      const Vector2 reference = beam.tip_under_moment(turn / length) / length;
      expect_tip("roll-up, L/t " + std::to_string(static_cast<int>(slenderness)) + ", load " +
                     std::to_string(0.25 * quarter).substr(0, 4),
                 path[5 * quarter - 1], reference, 1e-2);
      if (slenderness < 50) {
        const Vector2 elastica(std::sin(turn) / turn, (1 - std::cos(turn)) / turn);
        EXPECT_GT((elastica - reference).norm(), 2e-3);
      }
    }
  }
}

/// Tip positions over the length under alpha = P L^2/EI = 1, 2, 4, 10.
std::vector<Vector2> elastica(double slenderness) {
  Cantilever strip(slenderness, SolidLaw::stvk);
  Vector x = strip.rest();
  std::vector<Vector2> tips;
  double last = 0;
  for (double alpha : {1.0, 2.0, 4.0, 10.0}) {
    for (int part = 1; part <= 4; ++part) {
      strip.forces.setZero();
      const double load = (last + (alpha - last) * part / 4) / (length * length);
      for (int v : strip.tip) strip.add_force(v, {0, 0, load / 2});
      EXPECT_EQ(strip.minimise(x, 1e-6), Status::solved) << alpha;
    }
    last = alpha;
    tips.push_back(strip.tip_of(x));
  }
  return tips;
}

TEST(PrismShellElastica, OfThinStripsIsWithinHalfAPercentOfTheLength) {
  // (1 - shortening, deflection) by elliptic integrals (Bisshopp and Drucker 1945).
  const std::vector<Vector2> exact{{1 - 0.056433236, 0.301720774},
                                   {1 - 0.160641721, 0.493457480},
                                   {1 - 0.328941242, 0.669964181},
                                   {1 - 0.554995598, 0.810609025}};
  for (double slenderness : {100.0, 1000.0}) {
    const std::vector<Vector2> tips = elastica(slenderness);
    for (int i = 0; i < 4; ++i) {
      expect_tip("elastica, L/t " + std::to_string(static_cast<int>(slenderness)) + ", case " + std::to_string(i + 1),
                 tips[i], exact[i], 5e-3);
    }
  }
}

TEST(PrismShellElastica, OfThickStripsFollowsTheLawWithShearAndStretch) {
  for (double slenderness : {10.0, 20.0}) {
    const std::vector<Vector2> tips = elastica(slenderness);
    const Cantilever strip(slenderness, SolidLaw::stvk);
    const StvkBeam beam{strip.young, strip.thickness, 5.0 / 6, length};
    const double alphas[] = {1, 2, 4, 10};
    for (int i = 0; i < 4; ++i) {
      expect_tip("elastica, L/t " + std::to_string(static_cast<int>(slenderness)) + ", case " + std::to_string(i + 1),
                 tips[i], beam.tip_under_force(alphas[i] / (length * length)) / length, 5e-3);
    }
  }
}

}  // namespace
}  // namespace taut
