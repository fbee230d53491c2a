#include "solvers/nlopt.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>

#include "solvers/augmented_lagrangian.h"
#include "solvers/nonnegative_least_squares.h"
#include "support/random_values.h"
#include "support/small_cloth.h"

namespace taut {
namespace {

class NloptAgrees : public testing::TestWithParam<const char*> {};

TEST_P(NloptAgrees, WithTheAugmentedLagrangianOnEveryStepFromTheSameStates) {
  SmallCloth cloth(small_cloth_constraint(GetParam()));
  const Problem& problem = cloth.owned.problem;
  AugmentedLagrangianOptions tight;
  tight.tolerances = {1e-9, 1e-9, 1e-9};
  AugmentedLagrangian augmented_lagrangian(tight);
  Nlopt nlopt;
  WarmStart warm;
  double largest = 0;
  for (int step = 0; step < 6; ++step) {
    const Result other = augmented_lagrangian.solve(problem, warm, {});
    const Result result = nlopt.solve(problem, {}, {});
    ASSERT_EQ(other.status, Status::solved) << step << ": " << other.message;
    ASSERT_EQ(result.status, Status::solved) << step << ": " << result.message;
    EXPECT_LE((result.x - other.x).lpNorm<Eigen::Infinity>(), 1e-5) << step;
    largest = std::max(largest, result.multipliers[0].lpNorm<Eigen::Infinity>());
    warm = {other.multipliers, other.penalties, 0, {}};
    cloth.accept(other.x);
  }
  EXPECT_GT(largest, 1e-3) << "the constraint never acted";
}

INSTANTIATE_TEST_SUITE_P(, NloptAgrees, testing::Values("matrix_limit", "half_space", "sphere"),
                         [](const auto& kind) { return std::string(kind.param); });

class EveryNloptAlgorithm : public testing::TestWithParam<NloptAlgorithm> {};

TEST_P(EveryNloptAlgorithm, SaysSolvedExactlyWhereTheResidualsDo) {
  NloptOptions options;
  options.algorithm = GetParam();
  options.max_evaluations = 3000;
  Nlopt nlopt(options);
  SmallCloth cloth(small_cloth_constraint("matrix_limit"));
  for (int step = 0; step < 8; ++step) {
    const Result result = nlopt.solve(cloth.owned.problem, {}, {});
    EXPECT_EQ(result.status == Status::solved, residuals(cloth.owned.problem, result).within(options.tolerances));
    if (step < 2) {
      EXPECT_EQ(result.status, Status::solved) << result.message;
    }
    cloth.accept(result.x);
  }
}

TEST_P(EveryNloptAlgorithm, EndsAnInfeasibleStepUnsolvedWhateverNloptSays) {
  SmallCloth cloth(small_cloth_constraint("matrix_limit"));
  // Two corners held 1.5 m apart: every path between them is longer than the limit allows.
  const int corner = 3 * (SmallCloth::cells * (SmallCloth::cells + 1) + SmallCloth::cells);
  for (std::size_t i = 0; i < cloth.owned.problem.fixed_variables.size(); ++i)
    if (cloth.owned.problem.fixed_variables[i] == corner) cloth.owned.problem.fixed_values[static_cast<Index>(i)] = 1.5;
  NloptOptions options;
  options.algorithm = GetParam();
  options.max_evaluations = 2000;
  const Result result = Nlopt(options).solve(cloth.owned.problem, {}, {});
  EXPECT_NE(result.status, Status::solved) << result.message;
  EXPECT_GT(residuals(cloth.owned.problem, result).feasibility, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(, EveryNloptAlgorithm,
                         testing::Values(NloptAlgorithm::slsqp, NloptAlgorithm::auglag_slsqp,
                                         NloptAlgorithm::auglag_lbfgs, NloptAlgorithm::auglag_ccsaq,
                                         NloptAlgorithm::auglag_tnewton),
                         [](const auto& algorithm) { return std::string(to_string(algorithm.param)); });

/// A value that is NaN with derivatives that are not.
class NotANumber final : public Energy {
 public:
  explicit NotANumber(const Energy& energy) : energy_(energy) {}
  std::string name() const override { return "not a number"; }
  const Stencils& stencils() const override { return energy_.stencils(); }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override {
    return std::nan("") * energy_.evaluate(element, x, gradient, hessian, curvature);
  }

 private:
  const Energy& energy_;
};

TEST(Nlopt, CallsNothingSolvedThatIsNotFinite) {
  SmallCloth cloth(small_cloth_constraint("matrix_limit"));
  cloth.owned.add(std::shared_ptr<const Energy>(std::make_shared<NotANumber>(*cloth.inertia)));
  EXPECT_EQ(Nlopt().solve(cloth.owned.problem, {}, {}).status, Status::not_finite);
}

TEST(Nlopt, ItsClaimOfSuccessIsNotPassedOn) {
  // Limits that hold nearly everything in both directions: where both eigenvalues meet the limit the rows of the smooth
  // form have no constraint qualification, and SLSQP ends with a success code short of a solution. At which tolerance
  // depends on round-off, so that two are tried.
  SmallCloth cloth(small_cloth_constraint("upper_matrix_limit"));
  AugmentedLagrangian augmented_lagrangian;
  WarmStart warm;
  int false_successes = 0;
  for (int step = 0; step < 8; ++step) {
    for (double tolerance : {1e-6, 1e-11}) {
      NloptOptions options;
      options.tolerances = {tolerance, tolerance, tolerance};
      const Result result = Nlopt(options).solve(cloth.owned.problem, {}, {});
      const bool solved = residuals(cloth.owned.problem, result).within(options.tolerances);
      EXPECT_EQ(result.status == Status::solved, solved) << result.message;
      if (!solved && result.message.find("REACHED, the residuals do not agree") != std::string::npos) ++false_successes;
    }
    const Result other = augmented_lagrangian.solve(cloth.owned.problem, warm, {});
    warm = {other.multipliers, other.penalties, 0, {}};
    cloth.accept(other.x);
  }
  EXPECT_GT(false_successes, 0);
}

TEST(Nlopt, NamesTheLimitItRanInto) {
  SmallCloth cloth(small_cloth_constraint("matrix_limit"));
  NloptOptions few;
  few.max_evaluations = 2;
  EXPECT_EQ(Nlopt(few).solve(cloth.owned.problem, {}, {}).status, Status::iteration_limit);
  Budget late;
  late.deadline = std::chrono::steady_clock::now();
  EXPECT_EQ(Nlopt().solve(cloth.owned.problem, {}, late).status, Status::time_limit);
  const std::atomic<bool> raised = true;
  Budget stopped;
  stopped.stop = &raised;
  EXPECT_EQ(Nlopt().solve(cloth.owned.problem, {}, stopped).status, Status::interrupted);
}

TEST(Nlopt, SaysThatThereAreMoreEquationsThanUnknowns) {
  // The flat sheet cannot carry its weight across, but multipliers of 1e14 N would make that look small.
  SmallCloth cloth(small_cloth_constraint("inextensible"));
  const Result result = Nlopt().solve(cloth.owned.problem, {}, {});
  EXPECT_EQ(result.status, Status::stalled);
  EXPECT_EQ(result.message, "more equations than unknowns, which NLopt refuses");
}

TEST(Nlopt, RefusesProblemsThatAreTooLarge) {
  OwnedProblem owned;
  owned.problem.initial_guess = Vector::Zero(3 * largest_nlopt_problem(NloptAlgorithm::slsqp) + 3);
  EXPECT_THROW(Nlopt().solve(owned.problem, {}, {}), std::invalid_argument);
}

TEST(NonnegativeLeastSquares, MeetsTheConditionsOfOptimality) {
  RandomValues random(4);
  for (int sample = 0; sample < 50; ++sample) {
    const Matrix a = random.matrix(20, 12);
    const Vector b = random.vector(20);
    std::vector<char> free(12, 0);
    free[3] = free[7] = 1;
    const Vector x = nonnegative_least_squares(a, b, free), slope = a.transpose() * (b - a * x);
    for (Index i = 0; i < 12; ++i) {
      if (free[static_cast<std::size_t>(i)]) {
        EXPECT_NEAR(slope[i], 0, 1e-12);
        continue;
      }
      EXPECT_GE(x[i], 0);
      EXPECT_LE(slope[i], 1e-12);
      EXPECT_NEAR(x[i] * slope[i], 0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace taut
