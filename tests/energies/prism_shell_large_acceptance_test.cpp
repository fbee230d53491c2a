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
  Cantilever(double slenderness, SolidLaw law, int cells = 40, int points = 3)
      : ShellCase(make_grid(length, 1, cells, 1, Diagonals::alternating), length / slenderness),
        thickness(length / slenderness),
        young(12 / std::pow(thickness, 3)) {
    PrismShellOptions options;
    options.shear_correction = 5.0 / 6;
    options.points_in_thickness = points;
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

/// The tip after each of `steps` twentieths of the moment that rolls a beam up to a full circle.
std::vector<Vector2> roll_up(double slenderness, SolidLaw law, int steps, int cells = 40, int points = 3) {
  Cantilever strip(slenderness, law, cells, points);
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

/// Largest distance, over the quarters of the load up to `quarters`, from the beam with the same law.
double distance_from_law(double slenderness, int quarters, int cells, int points) {
  const std::vector<Vector2> path = roll_up(slenderness, SolidLaw::stvk, 5 * quarters, cells, points);
  const Cantilever strip(slenderness, SolidLaw::stvk);
  const StvkBeam beam{strip.young, strip.thickness, 5.0 / 6, length};
  double largest = 0, from_circle = 0;
  for (int quarter = 1; quarter <= quarters; ++quarter) {
    const double turn = pi / 2 * quarter;
    const Vector2 reference = beam.tip_under_moment(turn / length) / length;
    const Vector2 circle(std::sin(turn) / turn, (1 - std::cos(turn)) / turn);
    from_circle = std::max(from_circle, (path[5 * quarter - 1] - circle).norm());
    largest = std::max(largest, (path[5 * quarter - 1] - reference).norm());
  }
  std::printf("roll-up, L/t %4.0f, to load %.2f, %3d cells, %d points: largest distance %.5f, from the circle %.5f\n",
              slenderness, 0.25 * quarters, cells, points, largest, from_circle);
  return largest;
}

// St. Venant-Kirchhoff material is softer in bending than EI says: at L/t = 10 and three quarters of the load the tip
// is 0.16 of the length from the elastica.
TEST(PrismShellRollUp, OfThickerStripsFollowsTheBendingLawOfStVenantKirchhoff) {
  EXPECT_LE(distance_from_law(100, 4, 40, 3), 5e-3);
  EXPECT_LE(distance_from_law(20, 3, 40, 3), 5e-3);
  EXPECT_LE(distance_from_law(20, 4, 80, 3), 5e-3);
  EXPECT_LE(distance_from_law(10, 2, 40, 3), 5e-3);
  EXPECT_LE(distance_from_law(10, 3, 80, 3), 5e-3);
}

// Why three points through the thickness are the default: two converge to another limit, four to the same.
TEST(PrismShellRollUp, NeedsThreePointsThroughTheThickness) {
  const double two = distance_from_law(10, 3, 160, 2), three = distance_from_law(10, 3, 160, 3);
  EXPECT_GT(two, 1e-2);
  EXPECT_LE(three, 1e-3);
  EXPECT_NEAR(distance_from_law(10, 3, 160, 4), three, 1e-6);
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

struct Lifted {
  double load, inner, outer;
};

/// Heights of the inner and outer end of the slit's free edge at tenths of the load.
std::vector<Lifted> slit_annular(int radial, int around) {
  const auto ring = [](double x, double y) {
    const double angle = -2 * pi * x, radius = 6 + 4 * y;
    return Vector3(radius * std::cos(angle), radius * std::sin(angle), 0);
  };
  ShellCase plate(mapped_grid(around, radial, Diagonals::union_jack, ring), 0.03);
  PrismShellOptions options;
  options.shear_correction = 5.0 / 6;
  plate.set_material(-1, SolidMaterial::isotropic(SolidLaw::stvk, 21e6, 0), options);
  const auto vertex = [&](int i, int j) { return j * (around + 1) + i; };
  for (int j = 0; j <= radial; ++j) {
    for (int axis = 0; axis < 3; ++axis) plate.fix(vertex(around, j), axis);
  }
  Vector x = plate.rest();
  std::vector<Lifted> path;
  for (int step = 1; step <= 10; ++step) {
    plate.forces.setZero();
    for (int j = 0; j <= radial; ++j) {
      const double share = (j == 0 || j == radial ? 0.5 : 1.0) * 4 / radial;
      plate.add_force(vertex(0, j), {0, 0, 0.8 * step / 10 * share});
    }
    EXPECT_EQ(plate.minimise(x, 3e-5), Status::solved) << "step " << step;
    path.push_back({0.1 * step, plate.mean(vertex(0, 0), x).z(), plate.mean(vertex(0, radial), x).z()});
  }
  return path;
}

// The literature's curve (Sze, Liu and Lo 2004) was read off quadrilaterals on 10 x 80 cells.
TEST(PrismShellAnnular, FollowsTheCurveOfSzeWithinOnePercentOnSixteenBy128Cells) {
  const std::vector<Lifted> path = slit_annular(16, 128);
  ASSERT_EQ(path.size(), 10U);
  for (const Lifted& r : {Lifted{0.2, 6.725, 9.160},
                          {0.4, 9.529, 12.661},
                          {0.6, 11.257, 14.674},
                          {0.8, 12.642, 16.202},
                          {1.0, 13.891, 17.528}}) {
    const Lifted& ours = path[static_cast<std::size_t>(std::lround(10 * r.load)) - 1];
    const std::string at = ", load " + std::to_string(r.load).substr(0, 3);
    expect_ratio("slit annular plate, inner end" + at, ours.inner, r.inner, 0.01);
    expect_ratio("slit annular plate, outer end" + at, ours.outer, r.outer, 0.01);
  }
}

}  // namespace
}  // namespace taut
