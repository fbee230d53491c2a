#include "energies/shell_section.h"

#include <gtest/gtest.h>

#include "geometry/grid.h"
#include "geometry/layered_mesh.h"
#include "support/meshes.h"

namespace taut {
namespace {

constexpr double t = 0.2;

/// A sheet of 2 m x 1 m with layers of these Young's moduli (nu = 0), equally thick, and two prisms in the first.
struct Sheet {
  explicit Sheet(const std::vector<double>& moduli, const Vector3& direction = Vector3::UnitX())
      : mesh(make_grid(2, 1, 2, 2, Diagonals::alternating)) {
    std::vector<double> fractions;
    for (std::size_t k = 0; k < moduli.size(); ++k) {
      const int prisms = k == 0 ? 2 : 1;
      fractions.insert(fractions.end(), prisms, 1.0 / static_cast<double>(moduli.size()) / prisms);
    }
    layered = make_layered(mesh, std::vector{t}, fractions, "sheet");
    PrismShellOptions options;
    options.shear_correction = 5.0 / 6;
    std::vector<ShellSection::Layer> layers;
    auto first = layered.prisms.begin();
    for (std::size_t k = 0; k < moduli.size(); ++k) {
      const int prisms = k == 0 ? 2 : 1;
      const auto last = first + prisms * static_cast<std::ptrdiff_t>(mesh.triangles.size());
      energies.push_back(std::make_unique<PrismShell>("layer",
                                                      rest_prisms({first, last}, layered.nodes, Vector3(1, 1, 0)),
                                                      SolidMaterial::isotropic(SolidLaw::stvk, moduli[k], 0), options));
      layers.push_back({energies.back().get(), prisms});
      first = last;
    }
    section = std::make_unique<ShellSection>(layers, layered.prisms, layered.nodes, direction);
  }
  template <class Map>
  Vector moved(const Map& map) const {
    return flatten(mapped(layered.nodes, map));
  }

  TriangleMesh mesh;
  LayeredMesh layered;
  std::vector<std::unique_ptr<PrismShell>> energies;
  std::unique_ptr<ShellSection> section;
};

TEST(ShellSection, OfAStretchedSheetIsForceOverWidth) {
  const Sheet sheet({30, 50});
  const Vector x = sheet.moved([](const Vector3& p) { return Vector3(1.1 * p.x(), p.y(), p.z()); });
  const double strain = (1.1 * 1.1 - 1) / 2;
  for (int k = 0; k < sheet.section->triangles(); ++k) {
    const Resultants r = sheet.section->resultants(k, x);
    EXPECT_LE((r.n - Vector3(40 * t * strain, 0, 0)).norm(), 1e-12);
    // The stiffer layer is above the middle, its own middle at t/4.
    EXPECT_LE((r.m - Vector3(strain * (50 - 30) * t / 2 * t / 4, 0, 0)).norm(), 1e-12);
    EXPECT_LE(r.q.norm(), 1e-12);
    EXPECT_NEAR(sheet.section->state(k, 1, 1, x).stress[0], 50 * strain, 1e-12);
    EXPECT_NEAR(sheet.section->state(k, 0, 0, x).stress[0], 30 * strain, 1e-12);
    EXPECT_NEAR(sheet.section->state(k, 1, -1, x).stretches[0], 1.1, 1e-14);
    EXPECT_NEAR(sheet.section->state(k, 1, -1, x).stretches[2], 1, 1e-14);
  }
}

TEST(ShellSection, OfABentSheetIsItsStiffnessTimesTheCurvature) {
  const double curvature = 1e-6;
  const Sheet sheet({30});
  const Vector x = sheet.moved([&](const Vector3& p) {
    return Vector3(p.x() + curvature * p.x() * p.z(), p.y(), p.z() - curvature * p.x() * p.x() / 2);
  });
  const double moment = 30 * t * t * t / 12 * curvature;
  for (int k = 0; k < sheet.section->triangles(); ++k) {
    const Resultants r = sheet.section->resultants(k, x);
    EXPECT_LE((r.m - Vector3(moment, 0, 0)).norm(), 1e-5 * moment);
    EXPECT_LE(r.n.norm(), 1e-4 * moment / t);
    EXPECT_LE(r.q.norm(), 1e-4 * moment / t);
    // Counted in prisms the layer's height is continuous.
    EXPECT_NEAR(sheet.section->state(k, 0, -1, x).stress[0], -30 * curvature * t / 2, 1e-5 * 30 * curvature * t);
    EXPECT_NEAR(sheet.section->state(k, 0, 1, x).stress[0], 30 * curvature * t / 2, 1e-5 * 30 * curvature * t);
    EXPECT_NEAR(sheet.section->state(k, 0, 0.5, x).stress[0], 30 * curvature * t / 4, 1e-5 * 30 * curvature * t);
  }
}

TEST(ShellSection, OfAShearedSheetIsTheCorrectedStiffnessTimesTheAngle) {
  const double angle = 1e-6;
  const Sheet sheet({30});
  const Vector x = sheet.moved([&](const Vector3& p) { return Vector3(p.x(), p.y(), p.z() + angle * p.x()); });
  const double force = 5.0 / 6 * 15 * t * angle;
  for (int k = 0; k < sheet.section->triangles(); ++k)
    EXPECT_LE((sheet.section->resultants(k, x).q - Vector2(force, 0)).norm(), 1e-5 * force);
}

TEST(ShellSection, TurnsWithItsDirectionAndNotWithTheSheet) {
  const Sheet sheet({30, 50}, Vector3::UnitY());
  const Eigen::AngleAxisd turn(1.3, Vector3(1, 2, 3).normalized());
  const Vector x = sheet.moved([&](const Vector3& p) { return Vector3(turn * Vector3(1.1 * p.x(), p.y(), p.z())); });
  for (int k = 0; k < sheet.section->triangles(); ++k) {
    const Resultants r = sheet.section->resultants(k, x);
    EXPECT_LE((r.n - Vector3(0, 40 * t * (1.1 * 1.1 - 1) / 2, 0)).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace taut
