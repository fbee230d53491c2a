// The program that docs/guide/cpp_example.md shows, compiled and run here under another name than main.
#define main cpp_example_main
#include "tests/install_example/main.cpp"
#undef main

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "files/atomic_file.h"

namespace taut {
namespace {

TEST(CppExample, SolvesACatalogueProblem) {
  std::string program = "example", problem = TAUT_CATALOGUE "/tight_limits.json";
  char* arguments[] = {program.data(), problem.data(), nullptr};
  testing::internal::CaptureStdout();
  EXPECT_EQ(cpp_example_main(2, arguments), 0);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), testing::HasSubstr("t = 0.050 s: stationarity"));
}

TEST(CppExample, IsTheOneInTheGuide) {
  const std::string guide = read_bytes(TAUT_SOURCE_DIR "/docs/guide/cpp_example.md");
  EXPECT_THAT(guide,
              testing::HasSubstr("```cpp\n" + read_bytes(TAUT_SOURCE_DIR "/tests/install_example/main.cpp") + "```"));
}

}  // namespace
}  // namespace taut
