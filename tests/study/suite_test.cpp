#include "study/suite.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "study/suite_json.h"

namespace taut {
namespace {

SuiteRun run(Status status, double objective, double violation, double seconds) {
  SuiteRun run;
  run.outcome = "finished";
  run.status = status;
  run.objective = objective;
  run.violation = violation;
  run.seconds = seconds;
  return run;
}

TEST(Suite, CorrectIsTheBestKnownValueAtAFeasiblePoint) {
  const SuiteModel known{"known", "", 100.0}, unknown{"unknown", "", {}};
  EXPECT_TRUE(is_correct(known, run(Status::solved, 100.0009, 0, 1)));
  EXPECT_FALSE(is_correct(known, run(Status::solved, 100.0011, 0, 1)));
  EXPECT_TRUE(is_correct(known, run(Status::solved, 98, 0, 1))) << "better than what was known";
  EXPECT_FALSE(is_correct(known, run(Status::solved, 98, 1e-12, 1))) << "which a violation may have bought";
  EXPECT_FALSE(is_correct(known, run(Status::unbounded, -std::numeric_limits<double>::infinity(), 0, 1)));
  SuiteRun largest = run(Status::solved, 98, 0, 1);
  largest.maximise = true;
  EXPECT_FALSE(is_correct(known, largest));
  largest.objective = 102;
  EXPECT_TRUE(is_correct(known, largest));
  EXPECT_FALSE(is_correct(known, run(Status::solved, 100, 2e-6, 1)));
  EXPECT_FALSE(is_correct(known, run(Status::solved, std::nan(""), 0, 1)));
  EXPECT_TRUE(is_correct(known, run(Status::stalled, 100, 0, 1))) << "the answer counts, not the word for it";
  EXPECT_TRUE(is_correct(unknown, run(Status::solved, 3, 0, 1)));
  EXPECT_FALSE(is_correct(unknown, run(Status::stalled, 3, 0, 1)));
  EXPECT_FALSE(is_correct(known, SuiteRun{}));
}

TEST(Suite, ScoresCountWhatIsNotCorrectAtTheTimeLimit) {
  Suite suite;
  suite.time_limit = 10;
  suite.models = {{"a", "", 1.0}, {"b", "", 2.0}, {"c", "", {}}};
  SuiteEntry entry;
  entry.runs = {run(Status::solved, 1, 0, 0.1), run(Status::stalled, 5, 0, 0.3), SuiteRun{}};
  entry.runs[1].false_success = true;
  const SuiteScore score = score_of(suite, entry);
  EXPECT_EQ(score.false_successes, 1);
  EXPECT_EQ(score.correct, 1);
  EXPECT_EQ(score.solved, 1);
  EXPECT_DOUBLE_EQ(score.median_seconds, 0.2);
  EXPECT_NEAR(score.mean_seconds + suite_mean_shift, std::cbrt(0.101 * 10.001 * 10.001), 1e-12);
  suite.entries = {entry, entry};
  suite.entries[1].runs[0].seconds = 0.2;
  const std::vector<Profile> profiles = performance_of(suite);
  EXPECT_DOUBLE_EQ(profiles[0](1), 1.0 / 3);
  EXPECT_DOUBLE_EQ(profiles[1](1.9), 0);
  EXPECT_DOUBLE_EQ(profiles[1](2), 1.0 / 3);
}

TEST(Suite, RunsSurviveBeingWritten) {
  SuiteRun written = run(Status::unbounded, -1e300, std::nan(""), 0.25);
  written.message = "falls";
  written.false_success = true;
  written.counts.linear_solves = 7;
  const SuiteRun read = parse_suite_run(suite_run_line(written));
  EXPECT_EQ(read.outcome, "finished");
  EXPECT_EQ(read.status, Status::unbounded);
  EXPECT_EQ(read.message, "falls");
  EXPECT_TRUE(read.false_success);
  EXPECT_EQ(read.objective, -1e300);
  EXPECT_TRUE(std::isnan(read.violation));
  EXPECT_EQ(read.seconds, 0.25);
  EXPECT_EQ(read.counts.linear_solves, 7);
  EXPECT_THROW(parse_suite_run("no run"), std::runtime_error);
}

}  // namespace
}  // namespace taut
