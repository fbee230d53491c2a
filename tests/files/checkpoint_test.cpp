#include "files/checkpoint.h"

#include <sys/wait.h>

#include <bit>
#include <csignal>
#include <limits>

#include "files/atomic_file.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using CheckpointTest = FilesTest;

Checkpoint sample() {
  Checkpoint checkpoint;
  checkpoint.input_hash = "00c0ffee00c0ffee";
  checkpoint.step = 42;
  checkpoint.arrays["positions"] = {0.1, -0.0, 1e-310, std::numeric_limits<double>::max(),
                                    -std::numeric_limits<double>::infinity()};
  checkpoint.arrays["empty"] = {};
  checkpoint.arrays["not a number"] = {std::bit_cast<double>(0x7ff80000deadbeefull),
                                       std::bit_cast<double>(0xfff8000000000001ull)};
  checkpoint.texts["status"] = std::string("two\nlines and a \0 byte", 22);
  checkpoint.texts[""] = "";
  return checkpoint;
}

std::vector<std::uint64_t> bits(const std::vector<double>& values) {
  std::vector<std::uint64_t> result;
  for (const double value : values) result.push_back(std::bit_cast<std::uint64_t>(value));
  return result;
}

TEST_F(CheckpointTest, EveryBitComesBackNaNsIncluded) {
  const Checkpoint written = sample();
  write_checkpoint(path("c"), written);
  const Checkpoint read = read_checkpoint(path("c"));
  EXPECT_EQ(read.input_hash, written.input_hash);
  EXPECT_EQ(read.step, 42);
  EXPECT_EQ(read.texts, written.texts);
  ASSERT_EQ(read.arrays.size(), written.arrays.size());
  for (const auto& [name, values] : written.arrays) EXPECT_EQ(bits(read.arrays.at(name)), bits(values)) << name;
}

TEST_F(CheckpointTest, AnEmptyCheckpointIsOne) {
  write_checkpoint(path("c"), {});
  const Checkpoint read = read_checkpoint(path("c"));
  EXPECT_EQ(read.step, 0);
  EXPECT_TRUE(read.arrays.empty() && read.texts.empty() && read.input_hash.empty());
}

TEST_F(CheckpointTest, ADamagedByteAnywhereIsNoticed) {
  write_checkpoint(path("c"), sample());
  for (std::size_t i = 0; i < std::filesystem::file_size(path("c")); ++i) {
    for (const int mask : {0x01, 0x80, 0xff}) {
      flip(path("c"), i, mask);
      const std::string message = message_of<FileError>([&] { read_checkpoint(path("c")); });
      EXPECT_TRUE(message.starts_with(path("c").string() + ": ")) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      flip(path("c"), i, mask);
    }
  }
  EXPECT_EQ(read_checkpoint(path("c")).step, 42);
}

TEST_F(CheckpointTest, ACutAnywhereIsNoticed) {
  write_checkpoint(path("c"), sample());
  for (std::size_t size = std::filesystem::file_size(path("c")); size-- > 0;) {
    std::filesystem::resize_file(path("c"), size);
    EXPECT_THROW(read_checkpoint(path("c")), FileError) << size;
  }
}

TEST_F(CheckpointTest, SurplusBytesAreNoticed) {
  write_checkpoint(path("c"), sample());
  write_atomically(path("c"), read_bytes(path("c")) + "x");
  EXPECT_THROW(read_checkpoint(path("c")), FileError);
}

TEST_F(CheckpointTest, OtherFilesAreRefusedByName) {
  write_atomically(path("c"), "{\"a JSON file\": \"long enough to hold a header\"}");
  EXPECT_EQ(message_of<FileError>([&] { read_checkpoint(path("c")); }),
            path("c").string() + ": is not a taut checkpoint");
  EXPECT_THROW(read_checkpoint(path("missing")), FileError);

  write_checkpoint(path("c"), {});
  std::string later = read_bytes(path("c"));
  later[8] = 2;
  write_atomically(path("c"), later);
  EXPECT_EQ(message_of<FileError>([&] { read_checkpoint(path("c")); }),
            path("c").string() + ": checkpoint of format version 2, this program reads version 1");
}

TEST_F(CheckpointTest, AKillWhileWritingLeavesAWholeCheckpoint) {
  Checkpoint checkpoint = sample();
  checkpoint.arrays["large"].assign(200'000, 1.5);
  write_checkpoint(path("c"), checkpoint);
  for (int round = 0; round < 20; ++round) {
    const pid_t child = ::fork();
    if (child == 0) {
      for (;;) write_checkpoint(path("c"), checkpoint);
    }
    ::usleep(static_cast<useconds_t>(2000 + 731 * round));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    ASSERT_EQ(read_checkpoint(path("c")).arrays["large"].size(), 200'000u);
  }
}

}  // namespace
}  // namespace taut
