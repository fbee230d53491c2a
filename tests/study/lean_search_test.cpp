#include "study/lean_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace taut {
namespace {

using testing::Contains;
using testing::Not;

/// A scene that is a formula: its answer at each level of a mesh (4 levels, second order), of a step (3 levels, first
/// order) and without something.
class LeanSearch : public testing::Test {
 protected:
  LeanSearch() {
    ladder_.simplifications = {refinement("mesh", 5, 4), refinement("step", 4, 1.8), omission("bending")};
  }
  static Simplification refinement(const std::string& name, int levels, double cost) {
    return {.name = name,
            .kind = Simplification::Kind::refinement,
            .levels = std::vector<std::string>(static_cast<std::size_t>(levels), name),
            .cost_ratio = cost,
            .apply = {}};
  }
  static Simplification omission(const std::string& name) {
    return {.name = name,
            .kind = Simplification::Kind::omission,
            .levels = {"as written", "without " + name},
            .cost_ratio = 1,
            .apply = {}};
  }

  virtual double answer(const Levels& levels) const {
    return 1 + mesh_ * std::pow(4, levels[0]) + step_ * std::pow(2, levels[1]) + bending_ * levels[2];
  }
  LeanRung run(const Levels& levels, long max_linear_solves) {
    ++runs_;
    LeanRung rung;
    rung.seconds = 100 / (std::pow(4, levels[0]) * std::pow(1.8, levels[1]));
    rung.linear_solves = 100 - levels[2];
    seconds_ += rung.seconds;
    if (budget_ > 0 && seconds_ > budget_) {
      rung.status = "time_limit";
      return rung;
    }
    if (slow_.contains(levels)) {
      rung.linear_solves = max_linear_solves > 0 ? std::min(max_linear_solves, 1000000L) : 1000000L;
      rung.seconds = static_cast<double>(rung.linear_solves);
      rung.status = rung.linear_solves < 1000000 ? "iteration_limit" : "stalled";
      return rung;
    }
    if (fails_.contains(levels)) {
      rung.status = "stalled";
      return rung;
    }
    rung.status = "solved";
    rung.answer = Answer{Vector::Constant(1, answer(levels)), 1};
    return rung;
  }
  LeanOutcome search(double tolerance) {
    const LeanRunner runner{.run = [this](const Levels& levels, long most) { return run(levels, most); },
                            .estimate = estimate_,
                            .interrupted = [this] { return interrupt_after_ > 0 && runs_ >= interrupt_after_; },
                            .out_of_time = [this] { return budget_ > 0 && seconds_ > budget_; }};
    return lean_search(ladder_, {tolerance, true}, runner);
  }
  double true_error(const LeanOutcome& outcome) const {
    return std::abs(answer(outcome.rungs.at(outcome.lean.value()).levels) - answer({0, 0, 0}));
  }
  static std::vector<Levels> levels_of(const LeanOutcome& outcome) {
    std::vector<Levels> levels;
    for (const LeanRung& rung : outcome.rungs) levels.push_back(rung.levels);
    return levels;
  }

  LeanLadder ladder_;
  double mesh_ = 1e-3, step_ = 1e-3, bending_ = 1e-4;
  std::set<Levels> fails_, slow_;
  std::function<ResidualTrial(const LeanRung&, const Levels&)> estimate_;
  int runs_ = 0, interrupt_after_ = 0;
  double seconds_ = 0, budget_ = 0;
};

TEST_F(LeanSearch, FindsAModelWithinTheToleranceWithoutTheFullScene) {
  for (const double tolerance : {0.2, 0.1, 0.05}) {
    const LeanOutcome outcome = search(tolerance);
    EXPECT_EQ(outcome.end, LeanEnd::verified) << tolerance;
    EXPECT_LE(true_error(outcome), tolerance);
    EXPECT_THAT(levels_of(outcome), Not(Contains(Levels{0, 0, 0})));
    EXPECT_EQ(outcome.rungs[*outcome.lean].levels[2], 1) << "bending changes the answer by 1e-4 only";
    const double total = seconds_;
    EXPECT_LT(total, 100) << "cheaper than the full scene";
    seconds_ = 0;
  }
}

TEST_F(LeanSearch, TighterTolerancesNeedFinerModels) {
  const Levels loose = [this] {
    const LeanOutcome outcome = search(0.2);
    return outcome.rungs[*outcome.lean].levels;
  }();
  const LeanOutcome outcome = search(0.02);
  const Levels& tight = outcome.rungs[*outcome.lean].levels;
  EXPECT_LE(tight[0], loose[0]);
  EXPECT_LT(tight[0] + tight[1], loose[0] + loose[1]);
}

TEST_F(LeanSearch, KeepsWhatChangesTheAnswer) {
  bending_ = 0.3;
  const LeanOutcome outcome = search(0.1);
  EXPECT_EQ(outcome.rungs[*outcome.lean].levels[2], 0);
  ASSERT_EQ(outcome.omissions.size(), 1u);
  EXPECT_FALSE(outcome.omissions[0].left_out);
  EXPECT_NEAR(outcome.omissions[0].change, 0.3, 1e-12);
}

TEST_F(LeanSearch, GoesFromTheMildestFormOfAnOmissionToTheSimplestThatServes) {
  ladder_.simplifications[2].levels = {"as written", "mild", "simple", "simplest"};
  const auto tried = [this](double tolerance) {
    std::vector<std::string> words;
    for (const OmissionTrial& trial : search(tolerance).omissions)
      words.push_back(trial.what + (trial.left_out ? ": left out" : ": " + trial.why));
    return words;
  };
  bending_ = 0.02;  // a level
  EXPECT_THAT(tried(0.15), testing::ElementsAre("mild: a simpler form serves", "simple: left out",
                                                "simplest: it changes the answer"));
  EXPECT_THAT(tried(0.03), testing::ElementsAre("mild: it changes the answer"));
}

TEST_F(LeanSearch, EndsWithTheFullSceneWhereNoCheapModelServes) {
  mesh_ = 0.5;
  step_ = 0.5;
  const LeanOutcome outcome = search(0.01);
  EXPECT_EQ(outcome.end, LeanEnd::exact);
  EXPECT_EQ(outcome.lean, outcome.full);
  EXPECT_LT(seconds_ - 100, 20) << "what came before was cheap";
}

TEST_F(LeanSearch, StartsAtTheFirstLevelsThatAreSolved) {
  fails_ = {{4, 3, 0}};
  const LeanOutcome outcome = search(0.1);
  EXPECT_EQ(outcome.end, LeanEnd::verified);
  EXPECT_EQ(outcome.rungs[1].levels, (Levels{3, 2, 0}));
  EXPECT_LE(true_error(outcome), 0.1);
}

TEST_F(LeanSearch, GivesUpAModelThatTakesMoreLinearSolvesThanItIsWorth) {
  ladder_.full_linear_solves = 2000;
  ladder_.simplifications[0].solve_ratio = 4;
  slow_ = {{4, 3, 0}};
  const LeanOutcome outcome = search(0.1);
  EXPECT_EQ(outcome.end, LeanEnd::verified);
  EXPECT_EQ(outcome.rungs[0].status, "iteration_limit");
  EXPECT_EQ(outcome.rungs[0].linear_solves, 2000 / 2 * 256) << "as much as half of the full scene";
  EXPECT_EQ(outcome.rungs[1].levels, (Levels{3, 2, 0}));
  EXPECT_LE(true_error(outcome), 0.1);
}

TEST_F(LeanSearch, NeedsNoRunWhereAResidualTellsTheDifference) {
  search(0.2);
  const double seconds_without = seconds_;
  seconds_ = 0;
  ladder_.simplifications[0].has_residual = true;
  estimate_ = [this](const LeanRung&, const Levels& finer) {
    ResidualTrial trial;
    trial.levels = finer;
    trial.answer = Answer{Vector::Constant(1, answer(finer)), 1};
    return trial;
  };
  const LeanOutcome outcome = search(0.2);
  EXPECT_EQ(outcome.end, LeanEnd::verified);
  EXPECT_LE(true_error(outcome), 0.2);
  ASSERT_FALSE(outcome.residual_trials.empty());
  const ResidualTrial& first = outcome.residual_trials[0];
  EXPECT_EQ(first.levels, (Levels{3, 3, 0}));
  EXPECT_NEAR(*first.change, mesh_ * (256 - 64), 1e-12);
  EXPECT_THAT(levels_of(outcome), Not(Contains(first.levels)));
  EXPECT_LT(seconds_, seconds_without);
}

TEST_F(LeanSearch, RunsTheFinerModelWhereAResidualIsNotTrustedAndAsksNoMore) {
  ladder_.simplifications[0].has_residual = true;
  int asked = 0;
  estimate_ = [&](const LeanRung&, const Levels& finer) {
    ++asked;
    ResidualTrial trial;
    trial.levels = finer;
    trial.why = "a constraint is active";
    return trial;
  };
  const LeanOutcome outcome = search(0.05);
  EXPECT_EQ(outcome.end, LeanEnd::verified);
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(outcome.residual_trials[0].why, "a constraint is active");
  EXPECT_THAT(levels_of(outcome), Contains(outcome.residual_trials[0].levels));
}

TEST_F(LeanSearch, VerifiesAgainstARunWhatAResidualHasSaid) {
  ladder_.simplifications[0].has_residual = true;
  estimate_ = [](const LeanRung& coarse, const Levels& finer) {  // as if a finer mesh changed nothing
    ResidualTrial trial;
    trial.levels = finer;
    trial.answer = coarse.answer;
    return trial;
  };
  const LeanOutcome outcome = search(0.05);
  EXPECT_LE(true_error(outcome), 0.05);
  EXPECT_TRUE(outcome.end == LeanEnd::verified || outcome.end == LeanEnd::exact);
}

TEST_F(LeanSearch, SaysThatTheFullSceneIsNotSolved) {
  mesh_ = 0.5;
  fails_ = {{0, 0, 0}};
  const LeanOutcome outcome = search(1e-6);
  EXPECT_EQ(outcome.end, LeanEnd::not_solved);
  EXPECT_FALSE(outcome.lean);
}

TEST_F(LeanSearch, GivesTheBestSoFarWhenTheTimeIsOverOrSomeoneInterrupts) {
  interrupt_after_ = 3;
  const LeanOutcome interrupted = search(0.01);
  EXPECT_EQ(interrupted.end, LeanEnd::interrupted);
  EXPECT_TRUE(interrupted.lean);
  interrupt_after_ = 0;
  budget_ = 1;
  seconds_ = 0;
  const LeanOutcome late = search(0.001);
  EXPECT_EQ(late.end, LeanEnd::over_budget);
  EXPECT_TRUE(late.lean);
}

/// Bending matters on meshes finer than the coarsest, on which it is screened.
class LateSurprise : public LeanSearch {
 protected:
  double answer(const Levels& levels) const override {
    return LeanSearch::answer(levels) - (levels[0] < 4 && levels[2] == 0 ? 0.05 : 0);
  }
};

TEST_F(LateSurprise, IsNoticedByTheVerification) {
  const LeanOutcome outcome = search(0.04);
  EXPECT_LE(true_error(outcome), 0.04);
  EXPECT_TRUE(outcome.omissions.at(0).left_out) << "by the screening";
  EXPECT_EQ(outcome.rungs[*outcome.lean].levels[2], 0) << "but not in the end";
}

/// The same, but only the finest mesh sees it.
class HiddenSurprise : public LeanSearch {
 protected:
  double answer(const Levels& levels) const override { return LeanSearch::answer(levels) - (levels[0] < 1 ? 0.5 : 0); }
};

TEST_F(HiddenSurprise, CannotBeNoticedByAnythingCheaperThanTheFullScene) {
  mesh_ = 1e-4;
  const LeanOutcome outcome = search(0.05);
  EXPECT_EQ(outcome.end, LeanEnd::verified) << "the guide says that this is how it fails";
  EXPECT_GT(true_error(outcome), 0.4);
}

}  // namespace
}  // namespace taut
