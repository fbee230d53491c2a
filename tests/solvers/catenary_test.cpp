#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "energies/dead_load.h"
#include "energies/membrane.h"
#include "solvers/augmented_lagrangian.h"
#include "support/meshes.h"
#include "support/problems.h"

namespace taut {
namespace {

constexpr double span = 1.0, width = 0.1, weight = 1.0;

/// The sag of `links` equal links with the weight of each shared by its ends: tan(angle_j) = (links - 1 - 2 j)/(2 H).
double chain_sag(double length, int links) {
  double low = 1e-6, high = 1e6;
  const double link = length / links;
  const auto reach = [&](double horizontal) {
    double sum = 0;
    for (int j = 0; j < links; ++j) sum += link * std::cos(std::atan(0.5 * (links - 1 - 2 * j) / horizontal));
    return sum;
  };
  for (int i = 0; i < 200; ++i) (reach(std::sqrt(low * high)) < span ? low : high) = std::sqrt(low * high);
  double sag = 0;
  for (int j = 0; 2 * j < links - 1; ++j) sag += link * std::sin(std::atan(0.5 * (links - 1 - 2 * j) / low));
  return sag;
}

/// The sag of a strip of this length, inextensible by a limit of 1, that hangs between two pins. Taut, its membrane is
/// at rest and carries nothing.
double strip_sag(double length, int links) {
  const Strip strip(width, length, links);
  OwnedProblem owned;
  // Two straight lines, all taut: 2 % beyond the limit.
  const double depth = 0.5 * std::sqrt(1.02 * 1.02 * length * length - span * span);
  owned.problem.initial_guess = flatten(mapped(strip.mesh.vertices, [&](const Vector3& v) {
    const double u = v.y() / length;
    return Vector3(v.x(), span * u, -2 * depth * std::min(u, 1 - u));
  }));
  owned.pin({0, 1, 2 * links, 2 * links + 1});
  owned.add(std::make_shared<DeadLoad>("gravity", strip.row_forces({0, 0, -weight * width * length / links})));
  owned.add(
      std::make_shared<Membrane>("membrane", strip.triangles, MembraneLaw::stvk, Lame::plane_stress(10.0, 0), 1.0));
  owned.add(std::make_shared<MatrixStrainLimit>(limit_on(strip.triangles, 0, 1.0)));
  AugmentedLagrangianOptions options;
  options.tolerances = {1e-8, 1e-8, 1e-8};
  const Result result = AugmentedLagrangian(options).solve(owned.problem, {}, {});
  EXPECT_EQ(result.status, Status::solved) << result.message;
  double lowest = 0;
  for (Index vertex = 0; vertex < result.x.size() / 3; ++vertex) lowest = std::min(lowest, result.x[3 * vertex + 2]);
  return -lowest;
}

// The continuous sag is a (cosh(span/(2 a)) - 1) with 2 a sinh(span/(2 a)) = length.
struct Case {
  double length, sag;
};

TEST(Catenary, OfAnInextensibleStripIsThatOfAChainOfLinks) {
  for (const Case& c : {Case{1.05, 0.13930420659206322}, {1.1, 0.20030079073603765}, {1.5, 0.5026332616482236}}) {
    EXPECT_NEAR(strip_sag(c.length, 16), chain_sag(c.length, 16), 1e-6) << c.length;
  }
}

TEST(Catenary, SagConvergesToTheContinuousOneWithOrderTwo) {
  const Case c{1.1, 0.20030079073603765};
  const double coarse = std::abs(strip_sag(c.length, 8) - c.sag), middle = std::abs(strip_sag(c.length, 16) - c.sag);
  const double fine = std::abs(strip_sag(c.length, 32) - c.sag);
  EXPECT_NEAR(std::log2(coarse / middle), 2, 0.2);
  EXPECT_NEAR(std::log2(middle / fine), 2, 0.2);
  EXPECT_LT(fine, 2e-3 * c.sag);
}

}  // namespace
}  // namespace taut
