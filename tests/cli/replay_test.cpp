// Sender and receiver of an acceleration stream as two processes, over a file, a pipe and UDP.
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <thread>

#include "files/atomic_file.h"
#include "files/packet_ports.h"
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
  /// The port that a receiver started on udp:0 says it listens on.
  std::string port_of_receiver() const {
    for (int k = 0; k < 500; ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      const std::string error = content(path("stderr"));
      const std::size_t at = error.find("udp:"), end = error.find('\n');
      if (at != error.npos && end != error.npos) return error.substr(at, end - at);
    }
    return "";
  }
  /// The packets of the recorded run.
  std::vector<StreamPacket> packets() const {
    PacketSource source(folder("run.acc"), {});
    std::vector<StreamPacket> all;
    while (auto packet = source.next(false)) all.push_back(std::move(*packet));
    return all;
  }
  /// Waits until a file has this many lines; false where it never has.
  static bool grows_to(const std::filesystem::path& file, std::ptrdiff_t lines) {
    for (int k = 0; k < 500; ++k) {
      const std::string text = content(file);
      if (std::count(text.begin(), text.end(), '\n') == lines) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }
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
  const std::string port = port_of_receiver();
  ASSERT_FALSE(port.empty());
  ASSERT_EQ(shell(std::string(TAUT_PROGRAM) + " replay " + folder("run.acc") + " --drop 7 --send " + port), 0);
  const Outcome outcome = wait(receiver);
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, testing::HasSubstr("1 of 40 accelerations lost"));
}

/// What a sender has put out so far is in the table of the receiver, while both are still running.
void expect_live(const std::vector<StreamPacket>& packets, PacketTarget& target,
                 const std::function<bool(std::ptrdiff_t lines)>& grows_to) {
  ASSERT_EQ(packets.size(), 42);  // the keyframe, 40 accelerations, the end
  for (int k = 0; k <= 10; ++k) target.put(packets[k]);
  EXPECT_TRUE(grows_to(1 + 11));
  for (int k = 12; k <= 15; ++k) target.put(packets[k]);  // 11 is late: nothing is certain
  target.put(packets[11]);
  EXPECT_TRUE(grows_to(1 + 16));
  for (int k = 17; k <= 16 + 8; ++k) target.put(packets[k]);  // 16 is lost: so it is with a packet of 8 steps later
  EXPECT_TRUE(grows_to(1 + 25));
  for (int k = 25; k < 42; ++k) target.put(packets[k]);
}

TEST_F(ReplayCommand, FramesAreWrittenWhileTheStreamComesThroughANamedPipe) {
  ASSERT_EQ(::mkfifo(folder("fifo").c_str(), 0600), 0);
  const pid_t receiver = start({"replay", folder("fifo"), "--window", "8", "--out", folder("live")});
  {
    PacketTarget target(folder("fifo"));
    expect_live(packets(), target,
                [&](std::ptrdiff_t lines) { return grows_to(path("live") / "trajectory.csv", lines); });
  }
  const Outcome outcome = wait(receiver);
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, testing::HasSubstr("1 of 40 accelerations lost"));
}

TEST_F(ReplayCommand, FramesAreWrittenWhileTheStreamComesOverUdp) {
  const pid_t receiver = start({"replay", "udp:0", "--window", "8", "--out", folder("live")});
  PacketTarget target(port_of_receiver());
  expect_live(packets(), target,
              [&](std::ptrdiff_t lines) { return grows_to(path("live") / "trajectory.csv", lines); });
  const Outcome outcome = wait(receiver);
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, testing::HasSubstr("1 of 40 accelerations lost"));
}

/// Recorded into a named pipe and rebuilt at the other end: two processes, nothing in between.
TEST_F(ReplayCommand, ARunIsRebuiltWhileItIsSolved) {
  const std::string program = TAUT_PROGRAM;
  ASSERT_EQ(::mkfifo(folder("fifo").c_str(), 0600), 0);
  const std::string command = program + " replay " + folder("fifo") + " --against " + folder("run.acc") + " > " +
                              folder("log") + " & " + program + " solve " + folder("modal.json") +
                              " --set time.steps=40 --quiet --record-accelerations " + folder("fifo") + "; wait";
  ASSERT_EQ(shell(command), 0);
  EXPECT_THAT(content(path("log")), testing::HasSubstr("0 of 40 accelerations lost"));
  EXPECT_THAT(content(path("log")), testing::HasSubstr("at the end |dq| 0\n"));
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
  expect_refused({"replay", folder(".")}, "is a directory");
  const DatagramReceiver taken(0);
  expect_refused({"replay", "udp:" + std::to_string(taken.port())}, "Address already in use");
  expect_refused({"replay", folder("run.acc"), "--send", folder("missing") + "/x"}, "missing");
  expect_refused({"replay", folder("run.acc"), "--send", folder("run.acc")}, "is the source itself");
  expect_refused({"replay", folder("run.acc"), "--window", "0"}, "--window");
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
