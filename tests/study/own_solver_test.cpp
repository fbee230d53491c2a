// The program that docs/guide/compare.md shows, compiled and run here under another name than main.
#define main own_solver_main
#include "tests/install_example/own_solver.cpp"
#undef main

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/atomic_file.h"

namespace taut {
namespace {

TEST(OwnSolver, OfTheGuideIsComparedAndItsFalseSuccessesCounted) {
  std::string program = "example", problem = TAUT_CATALOGUE "/hanging_cloth.json";
  char* arguments[] = {program.data(), problem.data(), nullptr};
  testing::internal::CaptureStdout();
  EXPECT_EQ(own_solver_main(2, arguments), 0);
  const std::string printed = testing::internal::GetCapturedStdout();
  EXPECT_THAT(printed, testing::HasSubstr("augmented_lagrangian: 30 solved, 0 false successes"));
  EXPECT_THAT(printed, testing::HasSubstr("penalty: "));
  EXPECT_THAT(printed, testing::Not(testing::HasSubstr("penalty: 30 solved")));
}

TEST(OwnSolver, IsTheOneInTheGuide) {
  const std::string guide = read_bytes(TAUT_SOURCE_DIR "/docs/guide/compare.md");
  EXPECT_THAT(guide, testing::HasSubstr("```cpp\n" +
                                        read_bytes(TAUT_SOURCE_DIR "/tests/install_example/own_solver.cpp") + "```"));
}

}  // namespace
}  // namespace taut
