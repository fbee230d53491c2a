// The program's sources are in no library that this test could link: it compiles the one that it tests.
#include "cli/progress.h"

#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <thread>

namespace taut {
namespace {

/// Sets an environment variable (nullptr: removes it) while it lives.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old, had_ = true;
    value ? ::setenv(name, value, 1) : ::unsetenv(name);
  }
  ~Environment() { had_ ? ::setenv(name_, old_.c_str(), 1) : ::unsetenv(name_); }

 private:
  const char* name_;
  std::string old_;
  bool had_ = false;
};

class ProgressTest : public testing::Test {
 protected:
  Progress::Clock clock() {
    return [this] { return std::chrono::steady_clock::time_point(std::chrono::milliseconds(now_)); };
  }
  long now_ = 1000;  ///< ms
};

/// What `run` prints to a stream that is no terminal.
template <typename Run>
std::string printed_to_file(Run run) {
  std::FILE* file = std::tmpfile();
  run(file);
  std::string text(static_cast<std::size_t>(std::ftell(file)), '\0');
  std::rewind(file);
  EXPECT_EQ(std::fread(text.data(), 1, text.size(), file), text.size());
  std::fclose(file);
  return text;
}

/// What `run` prints to a terminal of that many columns.
template <typename Run>
std::string printed_to_terminal(unsigned short columns, Run run) {
  int master = -1, slave = -1;
  winsize size{25, columns, 0, 0};
  EXPECT_EQ(::openpty(&master, &slave, nullptr, nullptr, &size), 0);
  std::FILE* file = ::fdopen(slave, "w");
  std::string text;
  // Read while it prints: a terminal holds only a few thousand bytes. The mark says where the text ends.
  constexpr char mark = '\x04';
  std::thread reader([&] {
    for (char c = 0; ::read(master, &c, 1) == 1 && c != mark;) text += c;
  });
  run(file);
  std::fputc(mark, file);
  std::fflush(file);
  reader.join();
  std::fclose(file);
  ::close(master);
  return text;
}

std::size_t characters(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

TEST_F(ProgressTest, AFastRunGivesOnePlainLine) {
  EXPECT_EQ(printed_to_file([&](std::FILE* file) {
              Progress progress("cloth", 100, file, 0, clock());
              for (long i = 1; i <= 100; ++i) now_ += 15, progress.update(i);
              progress.finish();
              progress.finish();
            }),
            "cloth: 100/100 in 1.5 s\n");
}

TEST_F(ProgressTest, ASlowRunGivesALineATenth) {
  const std::string text = printed_to_file([&](std::FILE* file) {
    Progress progress("cloth", 100, file, 0, clock());
    for (long i = 1; i <= 100; ++i) now_ += 1000, progress.update(i, "residual 1e-7");
    progress.finish();
  });
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 11);
  EXPECT_TRUE(text.starts_with("cloth: 10/100, 1/s, 1:30 min left, residual 1e-7\n")) << text;
}

TEST_F(ProgressTest, FewLongItemsGiveAtMostALineInTwoSeconds) {
  const std::string text = printed_to_file([&](std::FILE* file) {
    Progress progress("cloth", 10, file, 0, clock());
    for (long i = 1; i <= 10; ++i) now_ += 700, progress.update(i);
  });
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3) << text;
}

TEST_F(ProgressTest, AMinuteOfSilenceIsBroken) {
  const std::string text = printed_to_file([&](std::FILE* file) {
    Progress progress("cloth", 100000, file, 0, clock());
    for (long i = 1; i <= 300; ++i) now_ += 1000, progress.update(i);
  });
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5) << text;
}

TEST_F(ProgressTest, StepsBeforeAResumeSayNothingAboutTheSpeed) {
  const std::string text = printed_to_file([&](std::FILE* file) {
    Progress progress("cloth", 100, file, 80, clock());
    now_ += 20000;
    progress.update(90);
  });
  EXPECT_EQ(text, "cloth: 90/100, 2 s each, 20 s left\n");
}

TEST_F(ProgressTest, ATerminalLineIsRedrawnAtMostTenTimesASecondAndFitsTheWidth) {
  const Environment term("TERM", "xterm"), no_color("NO_COLOR", "1"), locale("LC_ALL", "C.UTF-8");
  for (const unsigned short columns : std::initializer_list<unsigned short>{5, 30, 80, 200}) {
    const std::string text = printed_to_terminal(columns, [&](std::FILE* file) {
      Progress progress("drapé", 1000, file, 0, clock());
      for (long i = 1; i <= 1000; ++i)
        now_ += 10, progress.update(i, "σ 1.0999 and a note that is far\ntoo long for any terminal in use today");
      progress.clear();
    });
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_LE(std::count(text.begin(), text.end(), '\r'), 102);
    EXPECT_GE(std::count(text.begin(), text.end(), '\r'), 90);
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find('\r', at), text.size());
      std::string line = text.substr(at, end - at);
      if (line.ends_with("\x1b[K")) line.resize(line.size() - 3);
      EXPECT_LT(characters(line), columns) << line;
      EXPECT_EQ(line.find('\x1b'), std::string::npos) << line;
      at = end + 1;
    }
    EXPECT_TRUE(text.ends_with("\r\x1b[K"));
  }
}

TEST_F(ProgressTest, TheBarShowsBarPercentRateRestAndNote) {
  const Environment term("TERM", "xterm"), no_color("NO_COLOR", "1"), locale("LC_ALL", "C");
  const std::string text = printed_to_terminal(120, [&](std::FILE* file) {
    Progress progress("cloth", 100, file, 0, clock());
    now_ += 10000;
    progress.update(50, "violation 1e-8");
    progress.finish();
  });
  EXPECT_EQ(text,
            "\rcloth ############------------  50%  50/100, 5/s, 10 s left, violation 1e-8\x1b[K"
            "\r\x1b[Kcloth: 50/100 in 10 s\r\n");
}

TEST_F(ProgressTest, ColourIsUsedOnlyWhereItIsWanted) {
  const auto bar = [&] {
    return printed_to_terminal(80, [&](std::FILE* file) { Progress("cloth", 10, file, 0, clock()).update(5); });
  };
  const Environment term("TERM", "xterm"), locale("LC_ALL", "C.UTF-8");
  {
    const Environment no_color("NO_COLOR", nullptr);
    EXPECT_NE(bar().find("\x1b[36m████████\x1b[2m░"), std::string::npos);
  }
  const Environment no_color("NO_COLOR", "1");
  EXPECT_NE(bar().find("████████░"), std::string::npos);
  const Environment dumb("TERM", "dumb");
  EXPECT_EQ(bar(), "");
}

}  // namespace
}  // namespace taut
