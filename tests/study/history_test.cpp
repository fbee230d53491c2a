#include "study/history.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/checkpoint.h"
#include "study/run.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

class HistoryTest : public FilesTest {
 protected:
  RunSummary run_watched(const Overrides& overrides, int step, const std::string& folder) const {
    RunOptions options;
    options.folder = path(folder);
    options.threads = 1;
    options.history_step = step;
    return run(tiny_scene(path("."), overrides), options);
  }
  std::vector<HistoryPoint> history(const std::string& folder) const {
    return read_history(path(folder) / "history.csv");
  }
};

TEST_F(HistoryTest, EndsWithinTheToleranceThatTheStepIsSolvedTo) {
  for (const char* method : {"central path", "loop", "null_space"}) {
    SCOPED_TRACE(method);
    Overrides overrides;
    if (method == std::string("loop")) overrides = {{"solver.central_path", "false"}};
    if (method == std::string("null_space")) overrides = {{"solver.method", "null_space"}};
    const RunSummary summary = run_watched(overrides, 4, method);
    ASSERT_EQ(summary.status, Status::solved);
    const std::vector<HistoryPoint> points = history(method);
    ASSERT_GT(points.size(), 2u);
    EXPECT_GT(points.front().stationarity, points.back().stationarity);
    EXPECT_LE(points.back().stationarity, 1e-6);
    EXPECT_LE(points.back().feasibility, 1e-6);
    EXPECT_GT(points.back().penalty, 0);
    for (std::size_t k = 1; k < points.size(); ++k) {
      EXPECT_GE(points[k].linear_solves, points[k - 1].linear_solves);
      EXPECT_GE(points[k].seconds, points[k - 1].seconds);
    }
  }
}

TEST_F(HistoryTest, WatchingChangesNoBit) {
  run_watched({}, 4, "watched");
  run_watched({}, 0, "alone");
  EXPECT_EQ(read_checkpoint(path("watched") / "checkpoint.bin").arrays,
            read_checkpoint(path("alone") / "checkpoint.bin").arrays);
  EXPECT_FALSE(std::filesystem::exists(path("alone") / "history.csv"));
}

#ifdef TAUT_WITH_IPOPT
TEST_F(HistoryTest, IpoptShowsItsIterates) {
  ASSERT_EQ(run_watched({{"solver.method", "ipopt"}}, 4, "ipopt").status, Status::solved);
  const std::vector<HistoryPoint> points = history("ipopt");
  ASSERT_GT(points.size(), 3u);
  EXPECT_GT(points.front().stationarity, 1e-2);
  EXPECT_LE(points.back().stationarity, 1e-5);
  EXPECT_LE(points.back().feasibility, 1e-6);
  EXPECT_EQ(points.back().linear_solves, static_cast<long>(points.size()) - 1);
}
#endif

TEST_F(HistoryTest, NloptShowsNone) {
  run_watched({{"solver.method", "nlopt"}, {"time.steps", "1"}, {"bodies.cloth.mesh.grid.cells", "[2,2]"}}, 1, "nlopt");
  EXPECT_THAT(history("nlopt"), SizeIs(0));
}

TEST_F(HistoryTest, AFileOfSomethingElseIsRefused) {
  std::ofstream(path("other.csv")) << "time,value\n1,2\n";
  EXPECT_THAT(message_of<FileError>([&] { read_history(path("other.csv")); }), HasSubstr("is no history of taut"));
}

}  // namespace
}  // namespace taut
