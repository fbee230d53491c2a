// Runs `taut compare` as a shell would; child_process_test.cpp has crashes and limits of processes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "study/child_process.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

class CompareCommand : public FilesTest {
 protected:
  int compare(const std::vector<std::string>& more) const {
    std::vector<std::string> command{
        TAUT_PROGRAM, "compare", "hanging_cloth", "--set", "bodies.cloth.mesh.grid.cells=[4,4]", "--steps", "3"};
    command.insert(command.end(), more.begin(), more.end());
    return run_child(command, path("log"), {.seconds = 50}).code;
  }
  std::string log() const { return read_bytes(path("log")); }
  std::string out() const { return path("out").string(); }
  Json entries() const { return Json::parse(read_bytes(path("out") / "compare.json"))["problems"][0]["entries"]; }
};

TEST_F(CompareCommand, ComparesAndResumes) {
  const std::vector<std::string> both{"--solvers", "augmented_lagrangian,multiplier_loop", "--repeat", "2", "--out",
                                      out()};
  ASSERT_EQ(compare(both), 0) << log();
  EXPECT_THAT(log(), HasSubstr("multiplier_loop"));
  EXPECT_THAT(log(), HasSubstr("Pareto front of s/step against dx: "));
  ASSERT_EQ(entries().size(), 2u);
  EXPECT_TRUE(entries()[0]["on_front"] || entries()[1]["on_front"]);
  for (const Json& entry : entries()) {
    EXPECT_EQ(entry["summary"]["solved"], 3);
    EXPECT_EQ(entry["summary"]["false_successes"], 0);
    EXPECT_EQ(entry["resumed"], false);
    EXPECT_EQ(entry["steps"][0]["seconds"].size(), 2u);
  }
  EXPECT_TRUE(std::filesystem::exists(path("out") / "compare.csv"));
  EXPECT_TRUE(std::filesystem::exists(path("out") / "compare.md"));
  std::vector<std::string> again = both;
  again.push_back("--resume");
  ASSERT_EQ(compare(again), 0) << log();
  for (const Json& entry : entries()) EXPECT_EQ(entry["resumed"], true);
  again[3] = "3";  // other repeats are another job
  ASSERT_EQ(compare(again), 0) << log();
  for (const Json& entry : entries()) EXPECT_EQ(entry["resumed"], false);
}

TEST_F(CompareCommand, ALimitEndsAProcessAndNotTheComparison) {
  ASSERT_EQ(
      compare({"--solvers", "augmented_lagrangian,multiplier_loop", "--free", "--memory-limit", "1", "--out", out()}),
      0)
      << log();
  ASSERT_EQ(entries().size(), 2u);
  for (const Json& entry : entries()) EXPECT_EQ(entry["outcome"], "out_of_memory");
}

TEST_F(CompareCommand, AReferenceWithoutTimeExitsWithThree) {
  EXPECT_EQ(compare({"--solvers", "augmented_lagrangian", "--time-limit", "1e-6"}), 3) << log();
  EXPECT_THAT(log(), HasSubstr("time_limit"));
}

TEST_F(CompareCommand, WrongUsageExitsWithTwo) {
  EXPECT_EQ(compare({}), 2);
  EXPECT_EQ(compare({"--solvers", "magic"}), 2);
  EXPECT_THAT(log(), HasSubstr("multiplier_loop"));
  EXPECT_EQ(compare({"--solvers", "multiplier_loop", "--vary", "form"}), 2);
  EXPECT_EQ(compare({"--solvers", "multiplier_loop", "--vary", "constraints.limit.form=round"}), 2);
  EXPECT_EQ(compare({"--solvers", "multiplier_loop", "--resume"}), 2);
  EXPECT_EQ(compare({"--solvers", "multiplier_loop", "--out", path(".").string()}), 2);
  EXPECT_THAT(log(), HasSubstr("holds no comparison"));
}

}  // namespace
}  // namespace taut
