#ifdef TAUT_WITH_IPOPT
#include "solvers/ipopt.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>

#include "solvers/augmented_lagrangian.h"
#include "support/small_cloth.h"

namespace taut {
namespace {

constexpr Tolerances tight{1e-9, 1e-9, 1e-9};

double objective(const Problem& problem, const Vector& x) {
  double sum = 0;
  Vector local(max_stencil_width);
  for (const Energy* energy : problem.energies) {
    for (Index element = 0; element < energy->stencils().count(); ++element) {
      energy->stencils().gather(element, x, local.data());
      sum += energy->evaluate(element, local.data(), nullptr, nullptr, Curvature::exact);
    }
  }
  return sum;
}

/// An energy times a factor, or one that throws where its Hessian is asked for.
class Meddling final : public Energy {
 public:
  explicit Meddling(const Energy& energy, double factor, bool fails)
      : energy_(energy), factor_(factor), fails_(fails) {}
  std::string name() const override { return "meddling"; }
  const Stencils& stencils() const override { return energy_.stencils(); }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override {
    if (fails_ && hessian) throw std::runtime_error("meddling");
    return factor_ * energy_.evaluate(element, x, gradient, hessian, curvature);
  }

 private:
  const Energy& energy_;
  double factor_;
  bool fails_;
};

class IpoptAgrees : public testing::TestWithParam<const char*> {};

TEST_P(IpoptAgrees, WithTheAugmentedLagrangianOnEveryStepFromTheSameStates) {
  SmallCloth cloth(small_cloth_constraint(GetParam()));
  const Problem& problem = cloth.owned.problem;
  IpoptOptions options;
  options.tolerances = tight;
  Ipopt ipopt(options);
  options.warm_start = true;
  Ipopt warm_ipopt(options);
  AugmentedLagrangianOptions al_options;
  al_options.tolerances = tight;
  AugmentedLagrangian augmented_lagrangian(al_options);
  WarmStart warm, ipopt_warm;
  double largest = 0;
  for (int step = 0; step < 12; ++step) {
    const Result other = augmented_lagrangian.solve(problem, warm, {});
    const Result result = (step % 2 == 0 ? ipopt : warm_ipopt).solve(problem, ipopt_warm, {});
    ASSERT_EQ(other.status, Status::solved) << step << ": " << other.message;
    ASSERT_EQ(result.status, Status::solved) << step << ": " << result.message;
    EXPECT_TRUE(residuals(problem, result).within(tight));
    const double f = objective(problem, other.x), start = objective(problem, problem.initial_guess);
    EXPECT_NEAR(objective(problem, result.x), f, 1e-8 * std::max(std::abs(f), std::abs(start - f))) << step;
    EXPECT_LE((result.x - other.x).lpNorm<Eigen::Infinity>(), 1e-6) << step;
    largest = std::max(largest, result.multipliers[0].lpNorm<Eigen::Infinity>());
    warm = {other.multipliers, other.penalties, 0, {}};
    ipopt_warm = {result.multipliers, {}, 0, {}};
    cloth.accept(other.x);
  }
  EXPECT_GT(largest, 1e-3) << "the constraint never acted";
}

INSTANTIATE_TEST_SUITE_P(, IpoptAgrees,
                         testing::Values("matrix_limit", "upper_matrix_limit", "singular_value_limit", "half_space",
                                         "sphere"),
                         [](const auto& kind) { return std::string(kind.param); });

TEST(Ipopt, PressesATriangleOnAFloorWithTheForcesAsMultipliers) {
  OwnedProblem owned;
  owned.problem.initial_guess = flatten({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
  const std::vector<Vector3> rest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto inertia = std::make_shared<Inertia>(
      Inertia::lumped("inertia", rest_triangles(std::vector<Triangle>{{0, 1, 2}}, rest), 1.0, 3));
  owned.add(std::shared_ptr<const Energy>(inertia));
  inertia->set_target(1.0, flatten({{0, 0, -2}, {1, 0, -2}, {0, 1, -2}}));
  auto floor = std::make_shared<HalfSpace>("floor", "sheet", std::vector<int>{0, 1, 2}, 0, 1.0);
  floor->place({0, 0, 0}, {0, 0, 1});
  owned.add(std::shared_ptr<const Constraint>(floor));
  Ipopt ipopt;
  const Result result = ipopt.solve(owned.problem, {}, {});
  ASSERT_EQ(result.status, Status::solved) << result.message;
  EXPECT_LE((result.x - flatten({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})).norm(), 1e-6);
  // Each vertex has the mass 1/6 kg and is pulled 2 m below the floor by a spring of 1/6 N/m.
  for (double lambda : result.multipliers[0]) EXPECT_NEAR(lambda, -2.0 / 6, 1e-6);
}

TEST(Ipopt, NamesTheLimitItRanInto) {
  SmallCloth cloth(small_cloth_constraint("matrix_limit"));
  IpoptOptions few;
  few.max_iterations = 1;
  EXPECT_EQ(Ipopt(few).solve(cloth.owned.problem, {}, {}).status, Status::iteration_limit);
  Budget late;
  late.deadline = std::chrono::steady_clock::now();
  EXPECT_EQ(Ipopt().solve(cloth.owned.problem, {}, late).status, Status::time_limit);
  const std::atomic<bool> raised = true;
  Budget stopped;
  stopped.stop = &raised;
  EXPECT_EQ(Ipopt().solve(cloth.owned.problem, {}, stopped).status, Status::interrupted);
}

TEST(Ipopt, CallsNothingSolvedThatIsNotFinite) {
  SmallCloth cloth(small_cloth_constraint("matrix_limit"));
  const auto meddling = std::make_shared<Meddling>(*cloth.inertia, std::nan(""), false);
  cloth.owned.add(std::shared_ptr<const Energy>(meddling));
  EXPECT_EQ(Ipopt().solve(cloth.owned.problem, {}, {}).status, Status::not_finite);
}

TEST(Ipopt, PassesExceptionsOfItsCallbacksOn) {
  SmallCloth cloth(small_cloth_constraint("matrix_limit"));
  const auto meddling = std::make_shared<Meddling>(*cloth.inertia, 1.0, true);
  cloth.owned.add(std::shared_ptr<const Energy>(meddling));
  EXPECT_THROW(Ipopt().solve(cloth.owned.problem, {}, {}), std::runtime_error);
}

TEST(Ipopt, DoesNotCallAnInfeasibleStepSolved) {
  SmallCloth cloth(small_cloth_constraint("matrix_limit"));
  // Two corners held 1.5 m apart: every path between them is longer than the limit allows.
  for (std::size_t i = 0; i < cloth.owned.problem.fixed_variables.size(); ++i) {
    if (cloth.owned.problem.fixed_variables[i] == 3 * (SmallCloth::cells * (SmallCloth::cells + 1) + SmallCloth::cells))
      cloth.owned.problem.fixed_values[static_cast<Index>(i)] = 1.5;
  }
  const Result result = Ipopt().solve(cloth.owned.problem, {}, {});
  EXPECT_NE(result.status, Status::solved);
  EXPECT_GT(residuals(cloth.owned.problem, result).feasibility, 1e-3);
}

TEST(Ipopt, RejectsOptionsThatMakeNoSense) {
  IpoptOptions options;
  options.max_iterations = 0;
  EXPECT_THROW(Ipopt{options}, std::invalid_argument);
  options = {};
  options.warm_barrier = 0;
  EXPECT_THROW(Ipopt{options}, std::invalid_argument);
}

}  // namespace
}  // namespace taut
#endif
