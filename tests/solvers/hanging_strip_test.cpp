#include <gtest/gtest.h>

#include <cmath>

#include "energies/dead_load.h"
#include "energies/membrane.h"
#include "solvers/augmented_lagrangian.h"
#include "support/meshes.h"
#include "support/problems.h"

namespace taut {
namespace {

// A strip of length 1 m that hangs from its first row: weight rho g per area, membrane stiffness k = E t (N/m,
// Poisson's ratio 0), and a limit that holds its upper part. With s the distance from the top the tension per width is
// rho g (L - s); StVK carries T(d) = k d (d^2 - 1)/2 of it, at most T(limit).
constexpr double weight = 0.2 * 9.81, stiffness = 10.0, limit = 1.05, length = 1.0, width = 0.1;

double tension(double stretch) { return 0.5 * stiffness * stretch * (stretch * stretch - 1); }

double stretch_under(double load) {
  if (load >= tension(limit)) return limit;
  double d = 1;
  for (int i = 0; i < 50; ++i) d -= (tension(d) - load) / (0.5 * stiffness * (3 * d * d - 1));
  return d;
}

/// With row weights w/2, w, ..., w/2 the element around s_mid carries exactly rho g (L - s_mid).
double load_of(int element, int rows) { return weight * length * (1 - (element + 0.5) / rows); }

double discrete_length(int rows) {
  double sum = 0;
  for (int element = 0; element < rows; ++element) sum += stretch_under(load_of(element, rows)) * length / rows;
  return sum;
}

enum class Form { matrix, singular_values };

struct Hanging {
  Strip strip;
  OwnedProblem owned;
  Result result;

  Hanging(int rows, Form form) : strip(width, length, rows) {
    owned.problem.initial_guess =
        flatten(mapped(strip.mesh.vertices, [](const Vector3& v) { return Vector3(v.x(), -v.y(), 0); }));
    owned.pin({0, 1});
    owned.add(std::make_shared<DeadLoad>("gravity", strip.row_forces({0, -weight * width * length / rows, 0})));
    owned.add(std::make_shared<Membrane>("membrane", strip.triangles, MembraneLaw::stvk,
                                         Lame::plane_stress(stiffness, 0), 1.0));
    if (form == Form::matrix) {
      owned.add(std::make_shared<MatrixStrainLimit>(limit_on(strip.triangles, 0, limit)));
    } else {
      owned.add(std::make_shared<SingularValueStrainLimit>(limit_on(strip.triangles, 0, limit)));
    }
    AugmentedLagrangianOptions options;
    options.tolerances = {1e-9, 1e-9, 1e-9};
    result = AugmentedLagrangian(options).solve(owned.problem, {}, {});
  }
  double deformed_length() const { return -result.x[3 * 2 * strip.rows + 1]; }
  /// The tension per width that the limit carries in a triangle: 2 d Lambda, or the multiplier of d1.
  double limit_tension(int triangle) const {
    const Vector& m = result.multipliers[0];
    return m.size() == 3 * static_cast<Index>(strip.triangles.size())
               ? 2 * limit * (m[3 * triangle] + m[3 * triangle + 2])
               : m[2 * triangle];
  }
};

class HangingStrip : public testing::TestWithParam<Form> {};

TEST_P(HangingStrip, HasTheLengthFrontAndMultipliersOfTheDiscreteClosedForm) {
  const int rows = 40;
  const Hanging hanging(rows, GetParam());
  ASSERT_EQ(hanging.result.status, Status::solved) << hanging.result.message;
  EXPECT_NEAR(hanging.deformed_length(), discrete_length(rows), 1e-7);
  for (int element = 0; element < rows; ++element) {
    const double expected = std::max(load_of(element, rows) - tension(limit), 0.0);
    for (int side : {0, 1}) EXPECT_NEAR(hanging.limit_tension(2 * element + side), expected, 1e-6) << element;
  }
  // The front is where the multiplier, linear in s, reaches zero: s* = L - T(limit)/(rho g) = 0.7257262996941896.
  const double first = hanging.limit_tension(0), second = hanging.limit_tension(2);
  EXPECT_NEAR((0.5 + first / (first - second)) / rows, 0.7257262996941896, 1e-6);
}

TEST_P(HangingStrip, StaysFlatAndUnsheared) {
  const Hanging hanging(20, GetParam());
  for (int row = 0; row <= 20; ++row) {
    EXPECT_NEAR(hanging.result.x[6 * row], 0, 1e-7);
    EXPECT_NEAR(hanging.result.x[6 * row + 3], width, 1e-7);
    EXPECT_NEAR(hanging.result.x[6 * row + 1], hanging.result.x[6 * row + 4], 1e-7);
    EXPECT_EQ(hanging.result.x[6 * row + 2], 0);
  }
}

TEST_P(HangingStrip, ConvergesToTheContinuousLength) {
  // L + the integral of the stretch of each part: 1.0433064156472986 with the limit.
  const double exact = 1.0433064156472986;
  const double coarse = std::abs(Hanging(10, GetParam()).deformed_length() - exact);
  const double fine = std::abs(Hanging(40, GetParam()).deformed_length() - exact);
  EXPECT_LT(coarse, 2e-4);
  EXPECT_GT(std::log(coarse / fine) / std::log(4.0), 1.5);
}

TEST(HangingStripClosedForm, OfManyRowsIsTheContinuousOne) {
  EXPECT_NEAR(discrete_length(100000), 1.0433064156472986, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(, HangingStrip, testing::Values(Form::matrix, Form::singular_values),
                         [](const auto& form) { return form.param == Form::matrix ? "matrix" : "singular_values"; });

}  // namespace
}  // namespace taut
