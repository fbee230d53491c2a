#include "files/json_lines.h"

#include <sys/resource.h>
#include <sys/wait.h>

#include <csignal>

#include "files/atomic_file.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using LineFileTest = FilesTest;

TEST_F(LineFileTest, StartsEmptyUnlessToldOtherwise) {
  write_atomically(path("a"), "left from before\n");
  LineFile file(path("a"));
  EXPECT_EQ(read_bytes(path("a")), "");
  file.append("{\"step\": 1}");
  EXPECT_EQ(read_bytes(path("a")), "{\"step\": 1}\n");
}

TEST_F(LineFileTest, KeepsTheFirstLinesAndDropsTheRest) {
  write_atomically(path("a"), "1\n\n3\n4\n");
  LineFile file(path("a"), 2);
  EXPECT_EQ(read_bytes(path("a")), "1\n\n");
  file.append("again 3");
  EXPECT_EQ(read_bytes(path("a")), "1\n\nagain 3\n");
}

TEST_F(LineFileTest, DropsAHalfWrittenLastLine) {
  write_atomically(path("a"), "1\n2\n{\"ste");
  LineFile file(path("a"), 2);
  file.append("3");
  EXPECT_EQ(read_bytes(path("a")), "1\n2\n3\n");
}

TEST_F(LineFileTest, AHalfWrittenLineIsNotCountedAndTheFileIsLeftAlone) {
  write_atomically(path("a"), "1\n2\n3");
  const std::string message = message_of<FileError>([&] { LineFile(path("a"), 3); });
  EXPECT_EQ(message, path("a").string() + ": has 2 complete lines where 3 are needed");
  EXPECT_EQ(read_bytes(path("a")), "1\n2\n3");
}

TEST_F(LineFileTest, LinesAreCountedAcrossLargeFiles) {
  std::string kept;
  for (int i = 0; i < 40'000; ++i) kept += std::to_string(i) + "\n";
  write_atomically(path("a"), kept + "surplus\nhalf");
  LineFile file(path("a"), 40'000);
  EXPECT_TRUE(read_bytes(path("a")) == kept);
}

TEST_F(LineFileTest, AMissingFileIsNotMadeUpOnResume) {
  EXPECT_THROW(LineFile(path("a"), 1), FileError);
  EXPECT_FALSE(std::filesystem::exists(path("a")));
}

TEST_F(LineFileTest, RefusesWhatIsNotALine) {
  EXPECT_THROW(LineFile(path("a"), -1), std::invalid_argument);
  LineFile file(path("a"));
  EXPECT_THROW(file.append("1\n2"), std::invalid_argument);
  EXPECT_EQ(read_bytes(path("a")), "");
}

TEST_F(LineFileTest, NoFinishedLineIsLostToAKill) {
  int announced[2];
  ASSERT_EQ(::pipe(announced), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    LineFile file(path("a"));
    for (int i = 0;; ++i) {
      file.append(std::string(200, 'x') + std::to_string(i));
      if (::write(announced[1], &i, sizeof i) != sizeof i) ::_exit(1);
    }
  }
  int last = -1;
  while (last < 500) ASSERT_EQ(::read(announced[0], &last, sizeof last), static_cast<ssize_t>(sizeof last));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ::close(announced[0]);
  ::close(announced[1]);
  LineFile file(path("a"), last + 1);
  EXPECT_TRUE(read_bytes(path("a")).ends_with("x" + std::to_string(last) + "\n"));
}

TEST_F(LineFileTest, AFullDiskLeavesNoHalfLine) {
  LineFile file(path("a"));
  file.append("first");
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{20, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limit);
  EXPECT_THROW(file.append(std::string(100, 'x')), FileError);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  file.append("second");
  EXPECT_EQ(read_bytes(path("a")), "first\nsecond\n");
}

}  // namespace
}  // namespace taut
