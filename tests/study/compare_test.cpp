#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "problems/build.h"
#include "study/compare_json.h"
#include "study/compare_plan.h"
#include "study/compare_records.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/lying_solver.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class CompareSteps : public FilesTest {
 protected:
  Scene scene(const Overrides& overrides = {}) const { return tiny_scene(path("."), overrides); }
  EntryRun run(const std::string& label, const Scene& scene, const std::vector<State>& states, Solver& solver) const {
    EntryRun run;
    run.label = label;
    run.steps_asked = static_cast<int>(states.size());
    run.trials = compare_steps(scene, states, solver);
    return run;
  }
  static void measure(std::vector<EntryRun>& runs, const Scene& scene) {
    measure_distances(runs, scene.solver.tolerance, 1.0,
                      [&runs](std::size_t entry, std::size_t trial) { return runs[entry].trials[trial].result.x; });
  }
};

TEST_F(CompareSteps, TwoVariantsAgreeFromTheSameStates) {
  const Scene path = scene(), loop = scene({{"solver.central_path", "false"}});
  const std::vector<State> states = states_of(path, 8);
  ASSERT_EQ(states.size(), 8u);
  const auto first = build_solver(path, 1), second = build_solver(loop, 1);
  std::vector<EntryRun> runs{run("path", path, states, *first), run("loop", loop, states, *second)};
  measure(runs, path);
  for (const EntryRun& run : runs) {
    const EntrySummary summary = summarize(run);
    EXPECT_EQ(summary.solved, 8);
    EXPECT_EQ(summary.false_successes, 0);
    EXPECT_EQ(summary.distances, 8);
    EXPECT_LT(summary.position_distance, 1e-4);
  }
}

TEST_F(CompareSteps, ALiarIsCountedAsFalseSuccess) {
  const Scene honest = scene();
  const std::vector<State> states = states_of(honest, 3);
  LyingSolver liar(honest);
  const auto solver = build_solver(honest, 1);
  std::vector<EntryRun> runs{run("liar", honest, states, liar), run("honest", honest, states, *solver)};
  measure(runs, honest);
  const EntrySummary summary = summarize(runs[0]);
  EXPECT_EQ(summary.solved, 0);
  EXPECT_EQ(summary.false_successes, 3);
  EXPECT_EQ(runs[0].trials[0].distance->reference, "honest") << "a solution out of tolerance is no reference";
  EXPECT_NEAR(summary.position_distance, 0.01, 1e-3);
}

TEST_F(CompareSteps, ATrialIsReadBackAsWritten) {
  const Scene tiny = scene();
  const auto solver = build_solver(tiny, 1);
  const StepTrial trial = compare_steps(tiny, states_of(tiny, 1), *solver, {.repeat = 3}).front();
  EXPECT_EQ(trial.seconds.size(), 3u);
  EXPECT_GT(trial.warm_up_seconds, 0);
  EXPECT_EQ(trial_line(parse_trial(trial_line(trial))), trial_line(trial));
  EXPECT_THROW(parse_trial("{}"), std::runtime_error);
}

TEST(Variation, CommasInBracketsBelongToAValue) {
  EXPECT_THAT(parse_variation("a.b=1,2").values, ElementsAre("1", "2"));
  EXPECT_THAT(parse_variation("cells=[4,4],[8,8]").values, ElementsAre("[4,4]", "[8,8]"));
  for (const char* wrong : {"a", "=1", "a=", "a=1,,2"}) EXPECT_THROW(parse_variation(wrong), InputError) << wrong;
}

TEST_F(CompareSteps, EntriesAreEveryCombinationAndKnowWhichSolveTheSameProblem) {
  scene();
  EntryChoice choice;
  choice.solvers = {"augmented_lagrangian", "multiplier_loop"};
  choice.variations = {{"constraints.limit.form", {"matrix", "singular_values"}}, {"time.step", {"0.01", "0.02"}}};
  choice.tolerances = {1e-6, 1e-8};
  const ProblemPlan plan = plan_problem(path("tiny.json"), choice);
  ASSERT_EQ(plan.entries.size(), 16u);
  EXPECT_EQ(plan.entries[1].label, "augmented_lagrangian form=matrix step=0.01 tol=1e-08");
  EXPECT_EQ(plan.entries[1].scene.solver.tolerance.feasibility, 1e-8);
  EXPECT_EQ(plan.entries[0].group, plan.entries[4].group) << "another form of the same problem";
  EXPECT_NE(plan.entries[0].group, plan.entries[2].group) << "another step is another problem";
  choice.solvers = {"magic"};
  EXPECT_THAT(message_of<InputError>([&] { plan_problem(path("tiny.json"), choice); }), HasSubstr("multiplier_loop"));
}

TEST(Spread, IsMedianAndRange) {
  const Spread spread = spread_of({4, 1, 3, 2});
  EXPECT_EQ(spread.median, 2.5);
  EXPECT_EQ(spread.min, 1);
  EXPECT_EQ(spread.max, 4);
}

/// An entry of one step that took so long, ended so far from the reference, and was judged so.
EntryRun entry_of(const std::string& group, double seconds, double distance, Status judged = Status::solved) {
  EntryRun run;
  run.group = group;
  run.steps_asked = 1;
  StepTrial& trial = run.trials.emplace_back();
  trial.seconds = {seconds};
  trial.distance.emplace().positions = distance;
  trial.result.status = trial.judged = judged;
  return run;
}

TEST(Front, IsOfSolvedEntriesThatNoneOfTheirGroupBeatsInTimeAndDistance) {
  std::vector<EntryRun> runs{entry_of("", 1, 1e-3), entry_of("", 2, 1e-2),  // slower and farther than the first
                             entry_of("", 3, 1e-5), entry_of("", 0.5, 1e-9, Status::stalled),
                             entry_of(" step=2", 9, 1)};
  runs.push_back(entry_of("", 0.1, 1e-9));
  runs.back().steps_asked = 2;  // one of two
  runs.push_back(entry_of("", 0.1, 0));
  runs.back().trials.front().distance.reset();
  mark_front(runs);
  std::vector<bool> front;
  for (const EntryRun& run : runs) front.push_back(run.on_front);
  EXPECT_THAT(front, ElementsAre(true, false, true, false, true, false, false));
}

}  // namespace
}  // namespace taut
