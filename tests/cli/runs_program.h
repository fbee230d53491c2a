#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/files/temporary_folder.h"

namespace taut {

/// How the program ended.
struct Outcome {
  int code = -1;
  std::string out, error;
};

/// The bytes of a file.
inline std::string content(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Runs the built program as a shell would, each test with a folder of its own.
class RunsProgram : public FilesTest {
 protected:
  /// Starts the program; its output goes to files in this test's folder.
  pid_t start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), TAUT_PROGRAM);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    const std::string out = path("stdout"), error = path("stderr");
    const pid_t process = ::fork();
    if (process == 0) {
      const bool opened = std::freopen(out.c_str(), "w", stdout) && std::freopen(error.c_str(), "w", stderr);
      if (opened) ::execv(TAUT_PROGRAM, pointers.data());
      ::_exit(127);
    }
    EXPECT_GT(process, 0);
    return process;
  }
  Outcome wait(pid_t process) {
    int status = 0;
    EXPECT_EQ(::waitpid(process, &status, 0), process);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), content(path("stdout")),
            content(path("stderr"))};
  }
  Outcome taut(const std::vector<std::string>& arguments) { return wait(start(arguments)); }

  /// Bad usage and input: exit code 2 and one line on standard error that says so.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& message) {
    const Outcome outcome = taut(arguments);
    EXPECT_EQ(outcome.code, 2) << outcome.error;
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.error, testing::HasSubstr(message));
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
  }

  std::string folder(const std::string& name) const { return path(name).string(); }
};

}  // namespace taut
