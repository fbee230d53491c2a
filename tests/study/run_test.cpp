#include "study/run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "files/checkpoint.h"
#include "files/vtu.h"
#include "problems/build.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

/// The scene's own solver, with a hook that may change what it returns at the n-th call (from 1).
class MeddlingSolver final : public Solver {
 public:
  using Meddle = std::function<void(int call, Result&)>;
  MeddlingSolver(const Scene& scene, Meddle meddle) : solver_(build_solver(scene, 1)), meddle_(std::move(meddle)) {}
  std::string name() const override { return "meddler"; }
  Result solve(const Problem& problem, const WarmStart& warm, const Budget& budget) override {
    Result result = solver_->solve(problem, warm, budget);
    start_ = problem.initial_guess;
    meddle_(++calls_, result);
    return result;
  }
  int calls() const { return calls_; }
  const Vector& start() const { return start_; }

 private:
  std::unique_ptr<Solver> solver_;
  Meddle meddle_;
  int calls_ = 0;
  Vector start_;
};

class RunTest : public FilesTest {
 protected:
  Scene scene(const Overrides& overrides = {}) const { return tiny_scene(path("."), overrides); }

  RunOptions options(const std::string& folder) {
    RunOptions options;
    options.folder = path(folder);
    options.threads = 1;
    options.stop = &stop_;
    return options;
  }
  /// Runs and raises the stop flag after that many steps.
  RunSummary run_interrupted_after(int steps, const std::string& folder) {
    RunOptions interrupted = options(folder);
    interrupted.on_step = [this, steps](const StepRecord& record) { stop_ = record.step == steps; };
    const RunSummary summary = run(scene(), interrupted);
    stop_ = false;
    return summary;
  }
  RunSummary resume(const std::string& folder) {
    RunOptions resumed = options(folder);
    resumed.resume = true;
    return run(scene(), resumed);
  }
  /// steps.jsonl without the seconds.
  std::vector<Json> steps(const std::string& folder) const {
    std::ifstream file(path(folder) / "steps.jsonl");
    std::vector<Json> lines;
    for (std::string line; std::getline(file, line);) {
      lines.push_back(Json::parse(line));
      lines.back().erase("seconds");
    }
    return lines;
  }
  Json summary(const std::string& folder) const { return Json::parse(read_bytes(path(folder) / "summary.json")); }
  bool exists(const std::string& file) const { return fs::exists(path(file)); }

  std::atomic<bool> stop_{false};
};

void expect_same_bits(const fs::path& a, const fs::path& b) {
  const Checkpoint first = read_checkpoint(a / "checkpoint.bin"), second = read_checkpoint(b / "checkpoint.bin");
  EXPECT_EQ(first.step, second.step);
  EXPECT_EQ(first.arrays, second.arrays);
  EXPECT_EQ(first.texts.at("finished"), second.texts.at("finished"));
}

TEST_F(RunTest, SolvesEveryStepAndWritesWhatItPromises) {
  const RunSummary result = run(scene(), options("a"));
  EXPECT_EQ(result.status, Status::solved) << result.message;
  EXPECT_EQ(result.steps_solved, 8);
  const Json written = summary("a");
  EXPECT_EQ(written["status"], "solved");
  EXPECT_EQ(written["input_hash"], scene().hash);
  EXPECT_LE(written["violations"]["limit"]["max"], 1e-6);
  EXPECT_LE(written["residuals"]["stationarity"], 1e-6);
  EXPECT_EQ(steps("a").size(), 8u);
  for (const Json& file : written["files"]) EXPECT_TRUE(exists("a/" + file.get<std::string>())) << file;
  EXPECT_EQ(written["counts"]["symbolic_analyses"], 1);
  EXPECT_EQ(written["counts"]["matrix_allocations"], 1);
}

TEST_F(RunTest, FramesComeEveryFewStepsAndAtBothEnds) {
  run(scene(), options("a"));
  for (const int step : {0, 3, 6, 8}) EXPECT_TRUE(exists("a/frames/tiny_0000" + std::to_string(step) + ".vtu")) << step;
  for (const int step : {1, 2, 4, 5, 7})
    EXPECT_FALSE(exists("a/frames/tiny_0000" + std::to_string(step) + ".vtu")) << step;
  EXPECT_TRUE(exists("a/pictures/tiny_00004.svg"));
  EXPECT_TRUE(exists("a/pictures/tiny_00008.svg"));
  EXPECT_THAT(read_bytes(path("a") / "tiny.pvd"), HasSubstr("frames/tiny_00006.vtu"));
}

TEST_F(RunTest, FramesShowTheStateThatTheCheckpointHas) {
  const RunSummary result = run(scene(), options("a"));
  const Frame frame = read_vtu(path("a") / "frames" / "tiny_00008.vtu");
  const Checkpoint checkpoint = read_checkpoint(path("a") / "checkpoint.bin");
  EXPECT_EQ(std::vector<double>(frame.positions.begin(), frame.positions.end()), checkpoint.arrays.at("positions"));
  EXPECT_EQ(frame.point_fields.at(0).values, checkpoint.arrays.at("velocities"));
  std::map<std::string, std::vector<double>> cells;
  for (const Field& field : frame.cell_fields) cells[field.name] = field.values;
  const std::vector<double>& sigma = cells.at("sigma_max");
  int active = 0;
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    EXPECT_LE(sigma[i], 1.02 + 1.0001 * result.violations.at(0).max);
    EXPECT_LE(cells.at("sigma_min")[i], sigma[i]);
    EXPECT_EQ(cells.at("tension")[i] > 0, cells.at("active")[i] == 1) << "triangle " << i;
    if (cells.at("active")[i] != 1) continue;
    EXPECT_NEAR(sigma[i], 1.02, 1e-5) << "triangle " << i;
    ++active;
  }
  EXPECT_GT(active, 0) << "the scene is meant to reach its limit";
}

TEST_F(RunTest, AResumedRunEndsWithTheBitsOfOneNeverInterrupted) {
  for (const char* integrator : {"implicit_euler", "bdf2", "generalised_alpha"}) {
    SCOPED_TRACE(integrator);
    fs::remove_all(path("whole"));
    fs::remove_all(path("parts"));
    const Scene chosen = scene({{"time.integrator", integrator}});
    run(chosen, options("whole"));
    RunOptions parts = options("parts");
    parts.resume = true;
    for (const int last : {3, 4, 8}) {
      parts.on_step = [this, last](const StepRecord& record) { stop_ = record.step == last && last < 8; };
      const RunSummary part = run(chosen, parts);
      EXPECT_EQ(part.status, last < 8 ? Status::interrupted : Status::solved);
      stop_ = false;
    }
    expect_same_bits(path("whole"), path("parts"));
    EXPECT_EQ(steps("whole"), steps("parts"));
    EXPECT_EQ(summary("whole")["files"], summary("parts")["files"]);
    EXPECT_EQ(summary("whole")["residuals"], summary("parts")["residuals"]);
    EXPECT_EQ(read_bytes(path("whole") / "tiny.pvd"), read_bytes(path("parts") / "tiny.pvd"));
  }
}

TEST_F(RunTest, StepsLaterThanTheCheckpointAreDroppedAndDoneAgain) {
  run(scene(), options("whole"));
  run_interrupted_after(4, "killed");
  std::ofstream(path("killed") / "steps.jsonl", std::ios::app) << "{\"step\":5}\n{\"step\":6,";
  fs::remove(path("killed") / "summary.json");
  resume("killed");
  expect_same_bits(path("whole"), path("killed"));
  EXPECT_EQ(steps("whole"), steps("killed"));
}

TEST_F(RunTest, AnInterruptionBetweenStepsKeepsThemAll) {
  const RunSummary result = run_interrupted_after(5, "a");
  EXPECT_EQ(result.status, Status::interrupted);
  EXPECT_EQ(result.steps_done, 5);
  EXPECT_EQ(steps("a").size(), 5u);
  EXPECT_EQ(read_checkpoint(path("a") / "checkpoint.bin").step, 5);
  EXPECT_EQ(summary("a")["status"], "interrupted");
}

TEST_F(RunTest, AnInterruptionWithinAStepLeavesThatStepOut) {
  MeddlingSolver solver(scene(), [this](int call, Result& result) {
    if (call == 3) stop_ = true, result.status = Status::interrupted;
  });
  RunOptions meddled = options("a");
  meddled.solver = &solver;
  const RunSummary result = run(scene(), meddled);
  EXPECT_EQ(result.status, Status::interrupted);
  EXPECT_EQ(result.steps_done, 2);
  EXPECT_EQ(steps("a").size(), 2u);
  EXPECT_EQ(summary("a")["unfinished_step"]["step"], 3);
  stop_ = false;
  run(scene(), options("whole"));
  EXPECT_EQ(resume("a").status, Status::solved);
  expect_same_bits(path("whole"), path("a"));
}

TEST_F(RunTest, TimeThatIsOverIsATimeLimitAndTheRestCanBeResumed) {
  RunOptions short_of_time = options("a");
  short_of_time.max_seconds = 1e-9;
  EXPECT_EQ(run(scene(), short_of_time).status, Status::time_limit);
  EXPECT_EQ(resume("a").status, Status::solved);
}

TEST_F(RunTest, AFinishedRunIsNotRunAgain) {
  run(scene(), options("a"));
  const std::string before = read_bytes(path("a") / "summary.json");
  MeddlingSolver solver(scene(), [](int, Result&) {});
  RunOptions again = options("a");
  again.resume = true;
  again.solver = &solver;
  EXPECT_EQ(run(scene(), again).status, Status::solved);
  EXPECT_EQ(solver.calls(), 0);
  EXPECT_EQ(read_bytes(path("a") / "summary.json"), before);
}

TEST_F(RunTest, ResumingRefusesAnotherProblemAndAnotherNumberOfThreads) {
  run_interrupted_after(2, "a");
  RunOptions other = options("a");
  other.resume = true;
  EXPECT_THAT(message_of<RunRefused>([&] {
                run(scene({{"constraints.limit.max", "1.03"}}), other);
              }),
              HasSubstr("belongs to another problem"));
  other.threads = 2;
  EXPECT_THAT(message_of<RunRefused>([&] { run(scene(), other); }), HasSubstr("was run with 1 threads, not 2"));
  other.threads = 0;
  EXPECT_EQ(run(scene(), other).threads, 1);
}

TEST_F(RunTest, WhatIsWrittenDoesNotDecideWhetherARunMayBeResumed) {
  run_interrupted_after(2, "a");
  RunOptions resumed = options("a");
  resumed.resume = true;
  EXPECT_EQ(run(scene({{"output.every", "1"}}), resumed).status, Status::solved);
  EXPECT_TRUE(exists("a/frames/tiny_00004.vtu"));
}

TEST_F(RunTest, ADirectoryWithOtherThingsIsRefusedAndLeftAlone) {
  fs::create_directory(path("mine"));
  std::ofstream(path("mine") / "thesis.txt") << "irreplaceable";
  for (const bool resumes : {false, true}) {
    RunOptions refused = options("mine");
    refused.resume = resumes;
    EXPECT_THAT(message_of<RunRefused>([&] { run(scene(), refused); }), HasSubstr("holds no run of taut"));
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(path("mine")), {}), 1);
}

TEST_F(RunTest, ANewRunReplacesAnEarlierOneAndNothingElse) {
  run(scene({{"name", "old"}}), options("a"));
  std::ofstream(path("a") / "notes.txt") << "kept";
  run(scene({{"time.steps", "2"}}), options("a"));
  EXPECT_EQ(steps("a").size(), 2u);
  EXPECT_FALSE(exists("a/frames/old_00000.vtu"));
  EXPECT_FALSE(exists("a/old.pvd"));
  EXPECT_FALSE(exists("a/pictures/old_00008.svg"));
  EXPECT_TRUE(exists("a/notes.txt"));
}

TEST_F(RunTest, TheWrittenProblemIsTheSameProblem) {
  const Scene original = scene({{"time.steps", "2"}});
  run(original, options("a"));
  const Scene again = read_scene(path("a") / "problem.json");
  EXPECT_EQ(again.hash, original.hash);
  EXPECT_EQ(again.name, original.name);
}

TEST_F(RunTest, AFailedStepIsWrittenAndEndsTheRun) {
  MeddlingSolver solver(scene(), [&solver](int call, Result& result) {
    if (call == 4) result.status = Status::iteration_limit, result.x = solver.start(), result.message = "gave up";
  });
  RunOptions meddled = options("a");
  meddled.solver = &solver;
  const RunSummary result = run(scene(), meddled);
  EXPECT_EQ(result.status, Status::iteration_limit);
  EXPECT_EQ(result.steps_done, 4);
  EXPECT_EQ(result.steps_solved, 3);
  EXPECT_EQ(result.message, "step 4: gave up");
  EXPECT_EQ(result.worst_elements_step, 4);
  EXPECT_EQ(steps("a").back()["status"], "iteration_limit");
  EXPECT_TRUE(exists("a/frames/tiny_00004.vtu")) << "a frame of the step that failed";
  EXPECT_TRUE(exists("a/pictures/tiny_00004.svg"));
  EXPECT_EQ(resume("a").status, Status::iteration_limit) << "it stays failed";
}

TEST_F(RunTest, AfterAFailedStepARunMayContinueButIsNotSolved) {
  const Scene stubborn = scene({{"solver.on_failure", "continue"}});
  MeddlingSolver solver(stubborn, [](int call, Result& result) {
    if (call == 4) result.status = Status::infeasible;
    if (call == 6) result.status = Status::stalled;
  });
  RunOptions meddled = options("a");
  meddled.solver = &solver;
  const RunSummary result = run(stubborn, meddled);
  EXPECT_EQ(result.status, Status::infeasible) << "the first status that is not solved";
  EXPECT_EQ(result.steps_done, 8);
  EXPECT_EQ(result.steps_solved, 6);
}

TEST_F(RunTest, ASolverThatLiesIsOverruledByTheJudge) {
  MeddlingSolver solver(scene(), [&solver](int call, Result& result) {
    if (call == 2) result.x = solver.start();  // still called solved
  });
  RunOptions meddled = options("a");
  meddled.solver = &solver;
  const RunSummary result = run(scene(), meddled);
  EXPECT_EQ(result.status, Status::stalled);
  EXPECT_EQ(steps("a").back()["status"], "stalled");
  EXPECT_THAT(result.message, HasSubstr("meddler says solved, but the residuals are not within tolerance"));
}

TEST_F(RunTest, AStepThatIsNotFiniteEndsTheRunAndLeavesFinitePositionsBehind) {
  const Scene stubborn = scene({{"solver.on_failure", "continue"}});
  MeddlingSolver solver(stubborn, [](int call, Result& result) {
    if (call == 3) result.x[7] = std::numeric_limits<double>::quiet_NaN();
  });
  RunOptions meddled = options("a");
  meddled.solver = &solver;
  EXPECT_EQ(run(stubborn, meddled).status, Status::not_finite);
  EXPECT_EQ(steps("a").size(), 3u);
  EXPECT_TRUE(summary("a")["residuals"]["stationarity"].is_null());
  const Checkpoint kept = read_checkpoint(path("a") / "checkpoint.bin");
  for (const double x : kept.arrays.at("positions")) EXPECT_TRUE(std::isfinite(x));
  RunOptions again = options("a");
  again.resume = true;
  EXPECT_EQ(run(stubborn, again).status, Status::not_finite);
}

TEST_F(RunTest, WithoutAFolderTheSameIsDoneAndNothingWritten) {
  RunOptions nowhere = options("a");
  nowhere.folder.clear();
  const RunSummary result = run(scene(), nowhere), written = run(scene(), options("a"));
  EXPECT_EQ(result.status, Status::solved);
  EXPECT_TRUE(result.files.empty());
  EXPECT_EQ(result.objective, written.objective);
}

TEST_F(RunTest, OptionsThatMakeNoSenseAreRefused) {
  RunOptions wrong;
  wrong.resume = true;
  EXPECT_THROW(run(scene(), wrong), std::invalid_argument);
  wrong = {};
  wrong.max_seconds = -1;
  EXPECT_THROW(run(scene(), wrong), std::invalid_argument);
}

}  // namespace
}  // namespace taut
