#include "energies/membrane.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/assembly.h"
#include "support/meshes.h"

namespace taut {
namespace {

constexpr double young = 500.0, poisson = 0.3, thickness = 0.02, area = 6.0;

/// A 2 m x 3 m patch with the stretches sx and sy.
struct Patch {
  TriangleMesh mesh = make_grid(2, 3, 3, 2, Diagonals::alternating);
  Membrane membrane;
  explicit Patch(MembraneLaw law, double ratio = poisson)
      : membrane("patch", rest_triangles(mesh.triangles, mesh.vertices), law, Lame::plane_stress(young, ratio),
                 thickness) {}
  Vector stretched(double sx, double sy) const {
    return flatten(mapped(mesh.vertices, [&](const Vector3& v) { return Vector3(sx * v.x(), sy * v.y(), 0); }));
  }
  double energy(double sx, double sy) const {
    const Vector x = stretched(sx, sy);
    return Assembly(x.size(), {&membrane}, {}, 1).value(x);
  }
  /// The force in x on the side x = 0, per rest length.
  double traction(double sx, double sy) const {
    const Vector x = stretched(sx, sy);
    Vector gradient;
    Assembly(x.size(), {&membrane}, {}, 1).gradient(x, gradient);
    double sum = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      if (mesh.vertices[v].x() == 0) sum -= gradient[3 * static_cast<Index>(v)];
    }
    return sum / 3;
  }
};

TEST(Membrane, OfStvkHasTheEnergyOfItsGreenStrain) {
  const Lame lame = Lame::plane_stress(young, poisson);
  const Patch patch(MembraneLaw::stvk);
  for (const auto& [sx, sy] : {std::pair{1.3, 0.8}, {1.1, 1.1}, {0.9, 1.0}, {1.0, 1.0}}) {
    const double e1 = 0.5 * (sx * sx - 1), e2 = 0.5 * (sy * sy - 1);
    const double density = lame.mu * (e1 * e1 + e2 * e2) + 0.5 * lame.lambda * (e1 + e2) * (e1 + e2);
    EXPECT_NEAR(patch.energy(sx, sy), thickness * area * density, 1e-13 * young);
  }
}

TEST(Membrane, OfStvkCarriesTheUniaxialTensionWithoutPoissonEffect) {
  // T(d) = k d (d^2 - 1)/2 per width, k = E t.
  const Patch patch(MembraneLaw::stvk, 0.0);
  for (double d : {0.8, 1.0, 1.05, 1.5})
    EXPECT_NEAR(patch.traction(d, 1), young * thickness * d * (d * d - 1) / 2, 1e-13 * young);
}

TEST(Membrane, OfNeoHookeanHasTheEnergyOfItsStretches) {
  const Lame lame = Lame::plane_stress(young, poisson);
  const Patch patch(MembraneLaw::neo_hookean);
  for (const auto& [sx, sy] : {std::pair{1.3, 0.8}, {1.1, 1.1}, {0.9, 1.0}, {1.0, 1.0}}) {
    const double log_j = std::log(sx * sy);
    const double density = 0.5 * lame.mu * (sx * sx + sy * sy - 2 - 2 * log_j) + 0.5 * lame.lambda * log_j * log_j;
    EXPECT_NEAR(patch.energy(sx, sy), thickness * area * density, 1e-13 * young);
  }
}

TEST(Membrane, OfBothLawsIsPlaneStressElasticityAtSmallStrain) {
  const double strain = 1e-4;
  for (MembraneLaw law : {MembraneLaw::stvk, MembraneLaw::neo_hookean}) {
    const Patch patch(law);
    // Free sides shrink by Poisson's ratio; the energy is then E/2 strain^2, the stress E strain.
    EXPECT_NEAR(patch.energy(1 + strain, 1 - poisson * strain), thickness * area * 0.5 * young * strain * strain,
                1e-3 * thickness * area * 0.5 * young * strain * strain);
    EXPECT_NEAR(patch.traction(1 + strain, 1 - poisson * strain), thickness * young * strain,
                1e-3 * thickness * young * strain);
    EXPECT_NEAR(patch.energy(1 + strain, 1 + strain), thickness * area * young / (1 - poisson) * strain * strain,
                1e-3 * thickness * area * young * strain * strain);
  }
}

TEST(Membrane, OfNeoHookeanIsInfiniteAtCollapseAndGuardsStepsFromIt) {
  const Patch neo_hookean(MembraneLaw::neo_hookean), stvk(MembraneLaw::stvk);
  EXPECT_EQ(neo_hookean.energy(1, 0), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isfinite(stvk.energy(1, 0)));
  EXPECT_TRUE(neo_hookean.membrane.guards_steps());
  EXPECT_FALSE(stvk.membrane.guards_steps());
  const Vector x = neo_hookean.stretched(1, 1), flatter = neo_hookean.stretched(1, 0) - x;
  EXPECT_NEAR(Assembly(x.size(), {&neo_hookean.membrane}, {}, 1).largest_step(x, flatter), 0.9, 1e-12);
}

}  // namespace
}  // namespace taut
