#include "study/stress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/atomic_file.h"
#include "problems/build.h"
#include "study/compare_json.h"
#include "study/stress_frontiers.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/lying_solver.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr const char* atlas_text = R"({
  "methods": ["augmented_lagrangian", "multiplier_loop"],
  "entries": {
    "steps": {
      "title": "Steps", "problem": "tiny", "knob": "time.step, s", "key": "time.step", "values": ["0.02", "0.04"],
      "quick": ["0.04"]
    }
  }
})";

/// An atlas of two values and two methods, whose cells are carried out by a command of the test's choice.
class StressCells : public FilesTest {
 protected:
  StressCells() {
    std::filesystem::create_directories(path("catalogue") / "stress");
    scene_ = tiny_scene(path("catalogue"), {{"time.steps", "2"}});
    write(atlas_text);
  }
  void write(const std::string& text) { write_atomically(atlas(), text); }
  std::filesystem::path atlas() const { return path("catalogue") / "stress" / "atlas.json"; }

  StressOptions options(const std::string& script) const {
    StressOptions options;
    options.atlas = atlas();
    options.folder = path("cells");
    options.threads = 2;
    options.max_seconds = 0.2;
    options.worker = {"/bin/sh", "-c", script, "worker"};
    return options;
  }
  /// The one map of the atlas, of which every cell has run the script.
  StressMap run(const std::string& script) const { return stress(options(script)).maps.at(0); }

  /// What a worker leaves of these trials.
  std::string leaves(const std::vector<StepTrial>& trials) const {
    std::string lines;
    for (const StepTrial& trial : trials) lines += trial_line(trial) + "\n";
    write_atomically(path("lines"), lines);
    return "cp '" + path("lines").string() + "' \"$(dirname \"$1\")/steps.jsonl\"";
  }
  std::vector<StepTrial> trials(Solver& solver) const { return compare_steps(scene_, states_of(scene_, 2), solver); }

  Scene scene_;
};

void expect_all(const StressMap& map, StressOutcome outcome, const std::string& text) {
  ASSERT_EQ(map.cells.size(), 2u);
  for (const auto& row : map.cells) {
    ASSERT_EQ(row.size(), 2u);
    for (const StressCell& cell : row) {
      EXPECT_EQ(cell.outcome, outcome) << cell.text;
      EXPECT_THAT(cell.text, HasSubstr(text));
    }
  }
}

TEST_F(StressCells, AChildThatCrashesIsACrash) { expect_all(run("kill -SEGV $$"), StressOutcome::crash, "SIGSEGV"); }

TEST_F(StressCells, AnExceptionIsACrash) {
  expect_all(run("echo why >&2; exit 1"), StressOutcome::crash, "error: why");
}

TEST_F(StressCells, AChildThatHangsIsATimeout) { expect_all(run("sleep 60"), StressOutcome::timeout, "out of time"); }

TEST_F(StressCells, AChildThatLeavesNothingHasNotSolved) {
  expect_all(run("exit 0"), StressOutcome::crash, "without a step");
}

TEST_F(StressCells, AnInputThatIsRefusedIsAnHonestFailure) {
  expect_all(run("echo 'a.json: /gravity: found NaN' >&2; exit 2"), StressOutcome::honest_failure, "refused");
}

TEST_F(StressCells, AMethodThatIsRefusedDoesNotApply) {
  expect_all(run("echo 'a.json: /solver/method: found \"x\"' >&2; exit 2"), StressOutcome::not_applicable, "refused");
}

TEST_F(StressCells, SolvedStepsAreSolved) {
  const auto solver = build_solver(scene_, 1);
  const StressMap map = run(leaves(trials(*solver)));
  expect_all(map, StressOutcome::solved, "2 steps");
  EXPECT_EQ(frontier(map.cells[0]), 2);
}

TEST_F(StressCells, ALiarIsAFalseSuccess) {
  LyingSolver liar(scene_);
  expect_all(run(leaves(trials(liar))), StressOutcome::false_success, "step 1: says solved");
}

TEST_F(StressCells, ALieIsNotForgivenWhereTheProcessCrashesLater) {
  LyingSolver liar(scene_);
  expect_all(run(leaves(trials(liar)) + "; kill -SEGV $$"), StressOutcome::false_success, "says solved");
}

TEST_F(StressCells, AStatusWithANameIsAnHonestFailure) {
  const Overrides hurried{{"solver.central_path", "false"}, {"solver.max_newton", "1"}};
  const auto solver = build_solver(read_scene(path("catalogue") / "tiny.json", hurried), 1);
  const StressMap map = run(leaves(trials(*solver)));
  expect_all(map, StressOutcome::honest_failure, "iteration_limit");
}

TEST_F(StressCells, InfeasibleIsFalseWhereAnotherMethodSolves) {
  StressMap map;
  map.entry.methods = {"augmented_lagrangian", "ipopt"};
  map.entry.values = {{"1", {}, true}, {"2", {}, true}};
  const StressCell infeasible{StressOutcome::honest_failure, "step 1: infeasible", true, 0};
  map.cells = {{infeasible, infeasible}, {{StressOutcome::solved, "", false, 0}, infeasible}};
  find_false_infeasible(map);
  EXPECT_EQ(map.cells[0][0].outcome, StressOutcome::false_success);
  EXPECT_THAT(map.cells[0][0].text, HasSubstr("ipopt solves it"));
  EXPECT_EQ(map.cells[0][1].outcome, StressOutcome::honest_failure) << "nobody solves it";
}

TEST_F(StressCells, ChoicesAreKept) {
  StressOptions some = options("exit 0");
  some.methods = {"multiplier_loop"};
  some.quick = true;
  const StressMap map = stress(some).maps.at(0);
  EXPECT_THAT(map.entry.methods, ElementsAre("multiplier_loop"));
  ASSERT_EQ(map.entry.values.size(), 1u);
  EXPECT_EQ(map.entry.values[0].label, "0.04");
  some.entries = {"magic"};
  EXPECT_THAT(message_of<InputError>([&] { stress(some); }), HasSubstr("allowed: steps"));
  some.entries = {};
  some.methods = {"magic"};
  EXPECT_THAT(message_of<InputError>([&] { stress(some); }), HasSubstr("multiplier_loop"));
}

TEST_F(StressCells, AnAtlasThatDoesNotFitIsRefusedInOneLine) {
  const auto refusal = [this](const std::string& part, const std::string& replacement) {
    std::string text = atlas_text;
    text.replace(text.find(part), part.size(), replacement);
    write(text);
    return message_of<InputError>([this] { read_stress_atlas(atlas()); });
  };
  EXPECT_THAT(refusal("\"tiny\"", "\"none\""), HasSubstr("/entries/steps/problem: found none"));
  EXPECT_THAT(refusal("\"quick\": [\"0.04\"]", "\"quick\": [\"1\"]"), HasSubstr("/entries/steps/quick: found 1"));
  EXPECT_THAT(refusal("\"key\": \"time.step\",", ""), HasSubstr("/entries/steps: found no \"key\""));
  EXPECT_THAT(refusal("\"title\"", "\"titel\""), HasSubstr("/entries/steps/titel: found an unknown key"));
  EXPECT_THAT(refusal("\"multiplier_loop\"]", "\"magic\"]"), HasSubstr("magic"));
  EXPECT_THAT(refusal("[\"0.02\", \"0.04\"]", "[1]"), HasSubstr("/entries/steps/values/0"));
}

TEST(CatalogueAtlas, IsReadAndEveryEntryHasAQuickPart) {
  const auto entries = read_stress_atlas(std::filesystem::path(TAUT_CATALOGUE) / "stress" / "atlas.json");
  EXPECT_GE(entries.size(), 25u);
  for (const StressEntry& entry : entries) {
    EXPECT_TRUE(std::any_of(entry.values.begin(), entry.values.end(), [](const StressValue& v) { return v.quick; }))
        << entry.name;
    EXPECT_EQ(entry.methods.front(), default_method) << entry.name;
  }
}

/// One entry with three values, a method a row.
StressAtlas atlas_of(const std::vector<std::string>& methods, const std::vector<std::string>& rows) {
  StressAtlas atlas;
  StressMap& map = atlas.maps.emplace_back();
  map.entry.name = "knob";
  map.entry.methods = methods;
  map.entry.values = {{"1", {}, true}, {"2", {}, true}, {"3", {}, true}};
  for (const std::string& row : rows) {
    auto& cells = map.cells.emplace_back();
    for (const char letter : row)
      cells.push_back({static_cast<StressOutcome>(std::string("shfct-").find(letter)), "", false, 0});
  }
  return atlas;
}

TEST(StressFrontiers, OnlyWhatIsWorseIsARegression) {
  const StressAtlas stored = atlas_of({"ipopt"}, {"shh"});
  const auto worse = [&](const std::string& row) {
    return regressions(atlas_of({"ipopt"}, {row}), frontiers_text(stored), "stored.json");
  };
  EXPECT_THAT(worse("shh"), IsEmpty());
  EXPECT_THAT(worse("sss"), IsEmpty());
  EXPECT_THAT(worse("stt"), IsEmpty()) << "one honest failure is as good as another";
  EXPECT_THAT(worse("hss"), ElementsAre(StartsWith("knob: ipopt solves nothing, stored: up to 1")));
  EXPECT_THAT(worse("shf"), ElementsAre(StartsWith("knob at 3: ipopt has a false_success")));
  EXPECT_THAT(worse("shc"), ElementsAre(StartsWith("knob at 3: ipopt has a crash")));
}

TEST(StressFrontiers, TheDefaultSolverMayNotLieCrashOrLoseWithoutAReason) {
  const std::vector<std::string> methods{default_method, "ipopt"};
  const auto worse = [&](StressAtlas atlas) { return regressions(atlas, frontiers_text(atlas), "stored.json"); };
  EXPECT_THAT(worse(atlas_of(methods, {"shh", "shh"})), IsEmpty());
  EXPECT_THAT(worse(atlas_of(methods, {"shf", "shf"})),
              ElementsAre(HasSubstr("the default solver has a false_success")));
  EXPECT_THAT(worse(atlas_of(methods, {"shc", "shh"})), ElementsAre(HasSubstr("the default solver has a crash")));
  StressAtlas lost = atlas_of(methods, {"shh", "shs"});
  ASSERT_EQ(losses(lost).size(), 1u);
  EXPECT_EQ(losses(lost)[0].value, "3");
  EXPECT_EQ(losses(lost)[0].winner, "ipopt");
  EXPECT_THAT(worse(lost), ElementsAre(StartsWith("knob at 3: ipopt solves it")));
  lost.maps[0].entry.losses["3"] = "a mechanism";
  EXPECT_THAT(worse(lost), IsEmpty());
}

TEST(StressFrontiers, OfOtherValuesAreRefused) {
  const StressAtlas now = atlas_of({"ipopt"}, {"shh"});
  StressAtlas other = now;
  other.maps[0].entry.values[2].label = "4";
  EXPECT_THAT(message_of<InputError>([&] { regressions(now, frontiers_text(other), "stored.json"); }),
              StartsWith("stored.json: /knob/values: found \"1 2 4\""));
  EXPECT_THROW(regressions(now, R"({"knob": {"values": "1 2 3", "outcomes": {"ipopt": "sx"}}})", "f"), InputError);
  EXPECT_THROW(regressions(now, "{", "f"), InputError);
}

}  // namespace
}  // namespace taut
