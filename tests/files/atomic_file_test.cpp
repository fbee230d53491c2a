#include "files/atomic_file.h"

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using AtomicFileTest = FilesTest;

/// Lets no file of this process grow beyond `bytes` while it lives: a full disk in small.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(AtomicFileTest, EveryByteValueComesBack) {
  std::string bytes;
  for (int i = 0; i < 3'000'000; ++i) bytes += static_cast<char>(i * 7 % 256);
  write_atomically(path("a"), bytes);
  EXPECT_TRUE(read_bytes(path("a")) == bytes);
  write_atomically(path("a"), "");
  EXPECT_EQ(read_bytes(path("a")), "");
}

TEST_F(AtomicFileTest, LeavesNothingButTheFile) {
  write_atomically(path("a"), "one");
  write_atomically(path("a"), "two");
  EXPECT_EQ(read_bytes(path("a")), "two");
  const std::filesystem::directory_iterator files(path(""));
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

TEST_F(AtomicFileTest, AFullDiskLeavesTheOldContentAndNoLitter) {
  write_atomically(path("a"), "old");
  {
    const FileSizeLimit limit(1000);
    const std::string message = message_of<FileError>([&] { write_atomically(path("a"), std::string(5000, 'x')); });
    EXPECT_NE(message.find("cannot write: File too large"), std::string::npos) << message;
  }
  EXPECT_EQ(read_bytes(path("a")), "old");
  EXPECT_FALSE(std::filesystem::exists(path("a.partial")));
}

TEST_F(AtomicFileTest, WhatACrashLeftBehindIsOverwritten) {
  write_atomically(path("a.partial"), std::string(100, 'x'));
  write_atomically(path("a"), "new");
  EXPECT_EQ(read_bytes(path("a")), "new");
  EXPECT_FALSE(std::filesystem::exists(path("a.partial")));
}

TEST_F(AtomicFileTest, OtherPeopleMayReadTheFileAsTheUmaskAllows) {
  const mode_t before = ::umask(022);
  write_atomically(path("a"), "x");
  ::umask(before);
  EXPECT_EQ(static_cast<int>(std::filesystem::status(path("a")).permissions()), 0644);
}

TEST_F(AtomicFileTest, ErrorsNameTheFileInOneLine) {
  const std::string reading = message_of<FileError>([&] { read_bytes(path("none")); });
  EXPECT_EQ(reading, path("none").string() + ": cannot open: No such file or directory");
  const std::string writing = message_of<FileError>([&] { write_atomically(path("none/a"), "x"); });
  EXPECT_EQ(writing, path("none/a.partial").string() + ": cannot open: No such file or directory");
}

}  // namespace
}  // namespace taut
