#include "dynamics/modal/replay.h"

#include <gtest/gtest.h>

#include <cmath>

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

/// States after each step; steps in [first, first + count) are lost.
std::vector<SpectralState> replayed(const NewmarkRule& rule, const std::vector<Vector>& accelerations, Fill fill,
                                    int first, int count, std::vector<Vector>* used = nullptr) {
  Replay replay(rule, start(static_cast<int>(accelerations[0].size())), fill);
  std::vector<SpectralState> states;
  for (int k = 0; k < steps; ++k) {
    const bool lost = k >= first && k < first + count;
    if (used) used->push_back(lost ? replay.predicted() : accelerations[k]);
    replay.advance(lost ? std::optional<Vector>() : accelerations[k]);
    states.push_back(replay.state());
  }
  return states;
}

/// The lemma and theorem of MW (A.18)-(A.25).
TEST(Replay, OneLossUnderTheAverageAccelerationDistortsByAQuarterOneTwoThree) {
  const NewmarkRule rule{1.0 / 64, 0.25, 0.5};
  const auto a = random_accelerations(3, 1);
  const auto truth = replayed(rule, a, Fill::zero, 0, 0), lossy = replayed(rule, a, Fill::zero, 20, 1);
  for (int k = 0; k < 40; ++k) {
    const double displacement = k == 0 ? 0.25 : k, velocity = k == 0 ? 0.5 : 1;
    const Vector dq = (truth[20 + k].q - lossy[20 + k].q) / (rule.step * rule.step);
    const Vector dv = (truth[20 + k].v - lossy[20 + k].v) / rule.step;
    for (int mode = 0; mode < 3; ++mode) {
      EXPECT_NEAR(dq[mode] / a[20][mode] / displacement, 1, 1e-12 * 100 / std::abs(a[20][mode])) << k;
      EXPECT_NEAR(dv[mode] / a[20][mode], velocity, 1e-12 / std::abs(a[20][mode])) << k;
    }
  }
}

/// To 1e-12 on data without round-off: accelerations that are small integers, a step that is a power of two.
TEST(Replay, TheLawOfOneLossHoldsTo1em12) {
  const NewmarkRule rule{1.0 / 64, 0.25, 0.5};
  Replay truth(rule, {Vector::Zero(1), Vector::Zero(1), Vector::Zero(1)}, Fill::zero), lossy = truth;
  const double expected_displacement[] = {0.25, 1, 2, 3, 4, 5, 6, 7}, expected_velocity[] = {0.5, 1, 1, 1, 1, 1, 1, 1};
  for (int k = 0; k < 8; ++k) {
    const Vector a = Vector::Constant(1, k == 0 ? 3 : 7 - 2 * k);
    truth.advance(a);
    lossy.advance(k == 0 ? std::optional<Vector>() : a);
    EXPECT_NEAR((truth.state().q - lossy.state().q)[0] / (rule.step * rule.step * 3), expected_displacement[k], 1e-12);
    EXPECT_NEAR((truth.state().v - lossy.state().v)[0] / (rule.step * 3), expected_velocity[k], 1e-12);
  }
}

/// Any beta and gamma, bursts of 1 to 10, three fills: every lost acceleration distorts by the law times what the fill
/// is off by, and losses superpose.
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
          for (int lost = first; lost <= std::min(k, first + burst - 1); ++lost) {
            dq += law.displacement[k - lost] * (a[lost] - used[lost]);
            dv += law.velocity[k - lost] * (a[lost] - used[lost]);
          }
          // Round-off of q, of order 10, over h^2.
          EXPECT_LE(((truth[k].q - lossy[k].q) / (rule.step * rule.step) - dq).norm(), 1e-9) << beta << " " << burst;
          EXPECT_LE(((truth[k].v - lossy[k].v) / rule.step - dv).norm(), 1e-11) << beta << " " << burst;
        }
      }
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
  Replay lossy(rule, start(2), Fill::zero);
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
