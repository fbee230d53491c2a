#include "dynamics/modal/replay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "dynamics/modal/modal_integrator.h"
#include "support/random_values.h"
#include "support/small_basis.h"

namespace taut {
namespace {

constexpr int steps = 60;

std::vector<Vector> random_accelerations(int modes, unsigned seed) {
  RandomValues random(seed);
  std::vector<Vector> accelerations;
  for (int k = 0; k < steps; ++k) accelerations.push_back(random.vector(modes));
  return accelerations;
}

SpectralState start(int modes) {
  RandomValues random(77);
  return {random.vector(modes), random.vector(modes), random.vector(modes)};
}

/// At rest displacements are of the size of h^2 a, and so is their round-off; from a state of order 1 it would be 1/h^2
/// times as large as the accelerations'.
SpectralState at_rest(int modes) {
  SpectralState state = start(modes);
  state.q.setZero();
  state.v.setZero();
  return state;
}

/// States after each step; steps in [first, first + count) are lost.
std::vector<SpectralState> replayed(const NewmarkRule& rule, const std::vector<Vector>& accelerations, Fill fill,
                                    int first, int count, std::vector<Vector>* used = nullptr) {
  Replay replay(rule, at_rest(static_cast<int>(accelerations[0].size())), fill);
  std::vector<SpectralState> states;
  for (int k = 0; k < steps; ++k) {
    const bool lost = k >= first && k < first + count;
    if (used) used->push_back(lost ? replay.predicted() : accelerations[k]);
    replay.advance(lost ? std::optional<Vector>() : accelerations[k]);
    states.push_back(replay.state());
  }
  return states;
}

/// The lemma and theorem of MW (A.18)-(A.25), to 1e-12 of every factor.
TEST(Replay, OneLossUnderTheAverageAccelerationDistortsByAQuarterOneTwoThree) {
  for (const double h : {1.0 / 64, 0.01, 1e-4}) {
    const NewmarkRule rule{h, 0.25, 0.5};
    const auto a = random_accelerations(3, 1);
    const auto truth = replayed(rule, a, Fill::zero, 0, 0), lossy = replayed(rule, a, Fill::zero, 20, 1);
    for (int k = 0; k < 40; ++k) {
      const double displacement = k == 0 ? 0.25 : k, velocity = k == 0 ? 0.5 : 1;
      const Vector dq = (truth[20 + k].q - lossy[20 + k].q) / (h * h), dv = (truth[20 + k].v - lossy[20 + k].v) / h;
      EXPECT_LE((dq / displacement - a[20]).lpNorm<Eigen::Infinity>(), 1e-12) << h << " " << k;
      EXPECT_LE((dv / velocity - a[20]).lpNorm<Eigen::Infinity>(), 1e-12) << h << " " << k;
    }
  }
}

/// Any beta and gamma, bursts of 1 to 10, three fills: every lost acceleration distorts by the law times what the fill
/// is off by, and losses superpose. To 1e-12 of the sum of their sizes.
TEST(Replay, TheGeneralLawHoldsForAnyRuleBurstAndFill) {
  const auto a = random_accelerations(4, 2);
  for (const auto& [beta, gamma] : {std::pair(0.25, 0.5), std::pair(0.3025, 0.6), std::pair(1.0 / 6, 0.5),
                                    std::pair(0.5, 1.0), std::pair(0.05, 0.9)}) {
    const NewmarkRule rule{0.01, beta, gamma};
    const LossLaw law = loss_law(rule, steps);
    const auto truth = replayed(rule, a, Fill::zero, 0, 0);
    for (const Fill fill : {Fill::zero, Fill::hold, Fill::linear}) {
      for (int burst = 1; burst <= 10; ++burst) {
        constexpr int first = 20;
        std::vector<Vector> used;
        const auto lossy = replayed(rule, a, fill, first, burst, &used);
        for (int k = first; k < steps; ++k) {
          Vector dq = Vector::Zero(4), dv = Vector::Zero(4);
          double q_size = 0, v_size = 0;
          for (int lost = first; lost <= std::min(k, first + burst - 1); ++lost) {
            const Vector off = a[lost] - used[lost];
            dq += law.displacement[k - lost] * off;
            dv += law.velocity[k - lost] * off;
            q_size += law.displacement[k - lost] * off.norm();
            v_size += law.velocity[k - lost] * off.norm();
          }
          const double h = rule.step;
          EXPECT_LE(((truth[k].q - lossy[k].q) / (h * h) - dq).norm(), 1e-12 * q_size) << beta << " " << burst;
          EXPECT_LE(((truth[k].v - lossy[k].v) / h - dv).norm(), 1e-12 * v_size) << beta << " " << burst;
        }
      }
    }
  }
}

/// What limits the law away from rest: each step rounds q and v by a few units in their last place, and a velocity that
/// is off moves q in every step after that. |dq| <= 4 u (n Q + n^2/2 h V), |dv| <= 4 u n V, with Q and V the largest
/// |q| and |v| + h |a|, u = 2^-53. (In practice errors add up like a random walk.) The same recursion in long double
/// stands for the exact one.
TEST(Replay, RoundOffStaysBelowItsBoundThatGrowsWithTheSquareOfTheSteps) {
  constexpr double h = 0.01, beta = 0.25, gamma = 0.5, u = 0x1p-53;
  Replay replay({h, beta, gamma}, {Vector::Ones(1), Vector::Zero(1), -Vector::Ones(1)}, Fill::zero);
  long double q = 1, v = 0, before = -1;
  double largest_q = 1, largest_v = 0;
  for (int n = 1; n <= 100000; ++n) {
    const double a = -std::cos(n * h);
    q += h * v + static_cast<long double>(h) * h * ((0.5L - beta) * before + beta * a);
    v += h * ((1 - static_cast<long double>(gamma)) * before + gamma * a);
    before = a;
    replay.advance(Vector::Constant(1, a));
    largest_q = std::max(largest_q, static_cast<double>(std::abs(q)));
    largest_v = std::max(largest_v, static_cast<double>(std::abs(v)) + h);
    if (n % 1000 != 0) continue;
    const double off_q = static_cast<double>(std::abs(q - replay.state().q[0])),
                 off_v = static_cast<double>(std::abs(v - replay.state().v[0]));
    EXPECT_LE(off_q, 4 * u * (n * largest_q + 0.5 * n * (n * h) * largest_v)) << n;
    EXPECT_LE(off_v, 4 * u * n * largest_v) << n;
    if (n == 1000 || n == 10000 || n == 100000)
      std::printf("round-off after %6d steps: %.1e of q, %.1e of v\n", n, off_q, off_v);
    if (n == 100000) {
      EXPECT_GT(off_q, 1e-13);  // far above the last place of q
    }
  }
}

TEST(Replay, FillsAreTheLastOneAndTheLineThroughTheLastTwo) {
  Replay hold({0.1, 0.25, 0.5}, {Vector::Zero(1), Vector::Zero(1), Vector::Constant(1, 1)}, Fill::hold);
  Replay line({0.1, 0.25, 0.5}, {Vector::Zero(1), Vector::Zero(1), Vector::Constant(1, 1)}, Fill::linear);
  EXPECT_EQ(hold.predicted()[0], 1);
  for (Replay* replay : {&hold, &line}) replay->advance(Vector::Constant(1, 3));
  EXPECT_EQ(hold.predicted()[0], 3);
  EXPECT_EQ(line.predicted()[0], 5);
  line.advance({});
  EXPECT_EQ(line.predicted()[0], 7);
  line.advance(Vector::Constant(1, 9));  // two steps after 3
  EXPECT_EQ(line.predicted()[0], 12);
}

TEST(Replay, AKeyframeEndsAllDistortion) {
  const NewmarkRule rule{0.01, 0.25, 0.5};
  const auto a = random_accelerations(2, 3);
  const auto truth = replayed(rule, a, Fill::zero, 0, 0);
  Replay lossy(rule, at_rest(2), Fill::zero);
  for (int k = 0; k < steps; ++k) {
    lossy.advance(k == 5 ? std::optional<Vector>() : a[k]);
    if (k == 30) lossy.correct(truth[30]);
    EXPECT_EQ((lossy.state().q - truth[k].q).norm() > 0, k >= 5 && k < 30) << k;
  }
}

/// The counter-example: where accelerations are computed again from the distorted state, nothing grows.
TEST(Replay, InClosedLoopOneLossDoesNotGrowWhereInOpenLoopItDoes) {
  const auto basis = random_basis(1);
  const NewmarkRule rule{0.1, 0.25, 0.5};
  const Vector none(0), zero = Vector::Zero(1);
  ModalIntegrator truth(basis, rule, zero, {}), closed(basis, rule, zero, {});
  const SpectralState begin{Vector::Ones(1), zero, -Vector::Ones(1)};
  truth.restore(begin);
  closed.restore(begin);
  Replay open(rule, begin, Fill::zero);
  double closed_late = 0, open_late = 0;
  for (int k = 0; k < 4000; ++k) {
    truth.step(zero, none);
    closed.step(zero, none);
    open.advance(k == 5 ? std::optional<Vector>() : truth.state().a);
    if (k == 5) closed.restore(newmark_step(rule, begin, zero));  // a state that is wrong from here on
    if (k < 2000) continue;
    closed_late = std::max(closed_late, (closed.state().q - truth.state().q).norm());
    open_late = std::max(open_late, (open.state().q - truth.state().q).norm());
  }
  EXPECT_LE(closed_late, 2);
  EXPECT_GE(open_late, 20);
}

TEST(Replay, RefusesAnAccelerationOfAnotherSize) {
  Replay replay({0.1, 0.25, 0.5}, start(2), Fill::zero);
  EXPECT_THROW(replay.advance(Vector::Zero(3)), std::invalid_argument);
}

}  // namespace
}  // namespace taut
