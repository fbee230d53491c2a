// Sender and receiver of an acceleration stream as two processes, over a file, a pipe and UDP.
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "files/atomic_file.h"
#include "tests/cli/runs_program.h"
#include "tests/study/modal_scene.h"

namespace taut {
namespace {

class ReplayCommand : public RunsProgram {
 protected:
  void SetUp() override {
    RunsProgram::SetUp();
    modal_scene(path("."));
    const Outcome outcome = taut({"solve", path("modal.json").string(), "--set", "time.steps=40", "--quiet",
                                  "--record-accelerations", folder("run.acc")});
    ASSERT_EQ(outcome.code, 0) << outcome.error;
  }
  int shell(const std::string& command) { return std::system(command.c_str()); }
};

TEST_F(ReplayCommand, RebuildsFromAFileWithLossesAndWritesTableAndChart) {
  const Outcome outcome = taut({"replay", folder("run.acc"), "--drop", "5,6", "--fill", "hold", "--out", folder("o")});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, testing::HasSubstr("2 of 40 accelerations lost"));
  EXPECT_THAT(content(path("o") / "distortion.csv"), testing::HasSubstr("\n5,0.01,1,"));
  EXPECT_THAT(content(path("o") / "distortion.svg"), testing::HasSubstr("</svg>"));
  EXPECT_THAT(content(path("o") / "trajectory.csv"), testing::StartsWith("step,time,q1,"));
}

TEST_F(ReplayCommand, APipeCarriesTheStreamBetweenTwoProcesses) {
  const std::string program = TAUT_PROGRAM;
  const std::string command = program + " replay " + folder("run.acc") + " --drop 7 --send - | " + program +
                              " replay - --against " + folder("run.acc") + " --out " + folder("piped") + " > " +
                              folder("log");
  ASSERT_EQ(shell(command), 0);
  EXPECT_THAT(content(path("log")), testing::HasSubstr("1 of 40 accelerations lost"));
  ASSERT_EQ(taut({"replay", folder("run.acc"), "--drop", "7", "--out", folder("direct")}).code, 0);
  EXPECT_EQ(content(path("piped") / "trajectory.csv"), content(path("direct") / "trajectory.csv"));
}

TEST_F(ReplayCommand, UdpOnLoopbackCarriesItBetweenTwoProcesses) {
  const pid_t receiver = start({"replay", "udp:0", "--against", folder("run.acc"), "--out", folder("received")});
  std::string port;
  for (int k = 0; k < 200 && port.empty(); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::string error = content(path("stderr"));
    const std::size_t at = error.find("udp:"), end = error.find('\n');
    if (at != error.npos && end != error.npos) port = error.substr(at, end - at);
  }
  ASSERT_FALSE(port.empty());
  ASSERT_EQ(shell(std::string(TAUT_PROGRAM) + " replay " + folder("run.acc") + " --drop 7 --send " + port), 0);
  const Outcome outcome = wait(receiver);
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, testing::HasSubstr("1 of 40 accelerations lost"));
}

TEST_F(ReplayCommand, DamagedBytesAreSkippedAndCounted) {
  std::string bytes = read_bytes(path("run.acc"));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_atomically(path("bad.acc"), bytes.substr(0, bytes.size() - 5));
  const Outcome outcome = taut({"replay", folder("bad.acc"), "--against", folder("run.acc")});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, testing::HasSubstr("1 of 40 accelerations lost"));
  EXPECT_THAT(outcome.out, testing::HasSubstr("no end packet"));
}

TEST_F(ReplayCommand, RefusesWhatItCannotRebuild) {
  write_atomically(path("none"), "nothing of the kind");
  expect_refused({"replay", folder("none")}, "no keyframe");
  expect_refused({"replay", folder("missing")}, "missing");
  expect_refused({"replay", folder("run.acc"), "--loss", "2"}, "--loss");
  expect_refused({"replay", "udp:x"}, "udp:PORT");
  expect_refused({"replay", folder("run.acc"), "--against", folder("missing")}, "missing");
  expect_refused({"replay", folder("run.acc"), "--against", folder("none")}, "no keyframe");
  expect_refused({"replay", folder("run.acc"), "--out", folder("none") + "/x"}, "cannot be created");
  expect_refused({"modes", path("modal.json").string(), "--save", folder("missing") + "/m"}, "missing");
  expect_refused({"solve", path("modal.json").string(), "--record-accelerations", folder("missing") + "/x"}, "missing");
  expect_refused({"solve", "hanging_cloth", "--record-accelerations", folder("x.acc")}, "no modal body");
}

TEST_F(ReplayCommand, ModesAreListedWithTheirResidualsAndSaved) {
  const Outcome outcome = taut({"modes", path("modal.json").string(), "--save", folder("m")});
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, testing::HasSubstr("residual"));
  EXPECT_TRUE(std::filesystem::exists(path("m")));
}

}  // namespace
}  // namespace taut
