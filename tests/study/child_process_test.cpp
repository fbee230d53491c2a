#include "study/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <thread>

#include "files/atomic_file.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

class ChildProcess : public FilesTest {
 protected:
  ChildOutcome shell(const std::string& script, const ChildLimits& limits = {},
                     const std::atomic<bool>* stop = nullptr) const {
    return run_child({"/bin/sh", "-c", script}, path("log"), limits, stop);
  }
  std::string log() const { return read_bytes(path("log")); }
};

TEST_F(ChildProcess, TheExitCodeAndBothStreamsArriveInTheLog) {
  const ChildOutcome outcome = shell("echo out; echo error >&2; exit 7");
  EXPECT_EQ(outcome.end, ChildEnd::exited);
  EXPECT_EQ(outcome.code, 7);
  EXPECT_EQ(log(), "out\nerror\n");
  EXPECT_GT(outcome.peak_memory_bytes, 0);
}

TEST_F(ChildProcess, ACrashIsNamedByItsSignal) {
  const ChildOutcome outcome = shell("kill -SEGV $$");
  EXPECT_EQ(outcome.end, ChildEnd::crashed);
  EXPECT_EQ(outcome.signal, SIGSEGV);
  EXPECT_EQ(signal_name(outcome.signal), "SIGSEGV");
}

TEST_F(ChildProcess, TheTimeLimitEndsIt) {
  const ChildOutcome outcome = shell("sleep 30", {.seconds = 0.1});
  EXPECT_EQ(outcome.end, ChildEnd::time_limit);
  EXPECT_LT(outcome.seconds, 10);
}

TEST_F(ChildProcess, OneThatIgnoresSigtermIsKilledAfterTheGrace) {
  const ChildOutcome outcome =
      shell("trap '' TERM; while :; do sleep 0.05; done", {.seconds = 0.1, .grace_seconds = 0.1});
  EXPECT_EQ(outcome.end, ChildEnd::time_limit);
  EXPECT_LT(outcome.seconds, 10);
}

TEST_F(ChildProcess, TheMemoryLimitEndsIt) {
  constexpr std::int64_t limit = std::int64_t{100} << 20;
  // tail keeps what may be the last line, which never ends.
  const ChildOutcome outcome = run_child({"tail", "-n", "1", "/dev/zero"}, path("log"), {.memory_bytes = limit});
  EXPECT_EQ(outcome.end, ChildEnd::memory_limit);
  EXPECT_GT(outcome.peak_memory_bytes, limit / 2) << "the system counts in batches, so it may say a little less";
  EXPECT_EQ(shell("exit 0", {.memory_bytes = limit}).end, ChildEnd::exited);
}

TEST_F(ChildProcess, TheStopFlagEndsIt) {
  std::atomic<bool> stop{false};
  std::thread person([&stop] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stop = true;
  });
  const ChildOutcome outcome = shell("sleep 30", {}, &stop);
  person.join();
  EXPECT_EQ(outcome.end, ChildEnd::interrupted);
  EXPECT_LT(outcome.seconds, 10);
}

TEST_F(ChildProcess, WhatItHasStartedEndsWithIt) {
  EXPECT_EQ(shell("(sleep 1; echo late > '" + path("late").string() + "') & exit 0").code, 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  EXPECT_FALSE(std::filesystem::exists(path("late")));
}

TEST_F(ChildProcess, AProgramThatIsNotThereExitsWith127) {
  EXPECT_EQ(run_child({"/no/such/program"}, path("log"), {}).code, 127);
  EXPECT_THROW(run_child({}, path("log"), {}), std::invalid_argument);
}

}  // namespace
}  // namespace taut
