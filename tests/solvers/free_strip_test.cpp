#include <gtest/gtest.h>

#include <cmath>

#include "solvers/augmented_lagrangian.h"
#include "support/meshes.h"
#include "support/problems.h"

namespace taut {
namespace {

constexpr double target = 1.2, limit = 1.05, half_length = 1.0, width = 0.1, coefficient = 1.0;

// A free strip whose inertia wants the stretch 1.2, under a limit of 1.05: the nearest admissible shape is the strip
// stretched by 1.05 about its centre of mass, and the tension per width is rho (target - limit) (a^2 - X^2)/2 at X from
// the middle of a strip of half-length a.
struct Free {
  Strip strip;
  OwnedProblem owned;
  explicit Free(int rows, Diagonals diagonals = Diagonals::left) : strip(width, 2 * half_length, rows) {
    std::shared_ptr<Inertia> inertia = strip.inertia(width * 2 * half_length / rows);
    if (diagonals != Diagonals::left) {
      strip.mesh = make_grid(width, 2 * half_length, 1, rows, diagonals);
      strip.triangles = rest_triangles(strip.mesh.triangles, strip.mesh.vertices);
      inertia = std::make_shared<Inertia>(
          Inertia::lumped("inertia", strip.triangles, 1.0, static_cast<Index>(strip.mesh.vertices.size())));
    }
    owned.problem.initial_guess = stretched(target);
    inertia->set_target(coefficient, owned.problem.initial_guess);
    owned.add(std::shared_ptr<const Energy>(inertia));
    owned.add(std::make_shared<MatrixStrainLimit>(limit_on(strip.triangles, 0, limit)));
  }
  Vector stretched(double factor) const {
    return flatten(mapped(strip.mesh.vertices,
                          [&](const Vector3& v) { return Vector3(v.x(), factor * (v.y() - half_length), 0); }));
  }
  Result solve() {
    AugmentedLagrangianOptions options;
    options.tolerances = {1e-10, 1e-10, 1e-10};
    return AugmentedLagrangian(options).solve(owned.problem, {}, {});
  }
};

TEST(FreeStrip, IsStretchedToItsLimitAboutItsCentreOfMass) {
  for (Diagonals diagonals : {Diagonals::left, Diagonals::union_jack}) {
    Free free(20, diagonals);
    const Result result = free.solve();
    ASSERT_EQ(result.status, Status::solved) << result.message;
    EXPECT_LE((result.x - free.stretched(limit)).lpNorm<Eigen::Infinity>(), 1e-8);
  }
}

TEST(FreeStrip, HasTheTensionOfTheDiscreteAndInTheLimitOfTheContinuousStrip) {
  double last_error = 1;
  for (int rows : {10, 20, 40}) {
    Free free(rows);
    const Result result = free.solve();
    ASSERT_EQ(result.status, Status::solved) << result.message;
    const double step = 2 * half_length / rows;
    double carried = 0, error = 0;
    for (int element = 0; element < rows; ++element) {
      // The rows up to here pull outwards with mass times coefficient times distance from the target, per width.
      const double position = element * step - half_length;
      carried -= step * (element == 0 ? 0.5 : 1.0) * coefficient * (target - limit) * position;
      const double middle = position + 0.5 * step;
      const double continuous = coefficient * (target - limit) * 0.5 * (half_length * half_length - middle * middle);
      for (int side : {0, 1}) {
        const auto m = result.multipliers[0].segment<3>(3 * (2 * element + side));
        const double tension = 2 * limit * (m[0] + m[2]);
        EXPECT_NEAR(tension, carried, 1e-8);
        error = std::max(error, std::abs(tension - continuous));
      }
    }
    EXPECT_LT(error, last_error);
    if (rows > 10) {
      EXPECT_NEAR(std::log2(last_error / error), 2.0, 0.05);
    }
    last_error = error;
  }
}

}  // namespace
}  // namespace taut
