#include "report/stress_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "report/html_report.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Two methods, two values; the default solver loses the second.
StressAtlas small_atlas() {
  StressAtlas atlas;
  StressMap& map = atlas.maps.emplace_back();
  map.entry = {"knob",
               "A <knob>",
               "time.step, s",
               "stress/sheet",
               "sheet.json",
               {{"time.steps", "1"}},
               {{"1", {{"time.step", "1"}}, true}, {"2", {{"time.step", "2"}}, true}},
               {"augmented_lagrangian", "ipopt"},
               {{"2", "a mechanism"}}};
  const StressCell solved{StressOutcome::solved, "1 steps solved", false, 0};
  map.cells = {{solved, {StressOutcome::honest_failure, "a < b", false, 0}},
               {{StressOutcome::not_applicable, "", false, 0}, solved}};
  return atlas;
}

TEST(StressReport, CellsAreByMethodAndValueAndSayHowToRunThem) {
  const auto report = stress_report(small_atlas(), "taut stress");
  const nlohmann::json& map = report["heat_maps"].at(0);
  EXPECT_EQ(map["values"], (nlohmann::json{"1", "2"}));
  EXPECT_EQ(map["methods"], (nlohmann::json{"augmented_lagrangian", "ipopt"}));
  EXPECT_EQ(map["cells"][0][1]["outcome"], "honest_failure");
  EXPECT_EQ(map["cells"][1][0]["outcome"], "not_applicable");
  EXPECT_EQ(map["cells"][1][1]["command"],
            "taut solve stress/sheet --set time.steps=1 --set solver.method=ipopt --set time.step=2");
}

TEST(StressReport, SharesAreOfTheCellsWhereAMethodApplies) {
  const std::string text = stress_markdown(small_atlas());
  EXPECT_THAT(text, HasSubstr("| augmented_lagrangian | 2 | 1 | 50.0 % | 50.0 % | 1 | 0 | 0 | 0 |"));
  EXPECT_THAT(text, HasSubstr("| ipopt | 1 | 1 | 100.0 % | 0.0 % | 0 | 0 | 0 | 0 |"));
  EXPECT_THAT(text, HasSubstr("| knob | 1 | 2 | up to 1 | none (+1) |"));
  EXPECT_THAT(text, HasSubstr("| knob | 2 | ipopt | a < b | a mechanism |"));
}

class StressPictures : public FilesTest {};

TEST_F(StressPictures, HaveASignAndATooltipForEveryCell) {
  const auto files = write_report_pictures(path("out"), stress_report(small_atlas(), ""));
  ASSERT_EQ(files.size(), 1u);
  const std::string svg = read_bytes(files[0]);
  EXPECT_THAT(svg, HasSubstr("A &lt;knob&gt;"));
  EXPECT_THAT(svg, HasSubstr("<title>a &lt; b</title>"));
  EXPECT_THAT(svg, HasSubstr("○</text></g>"));
  EXPECT_THAT(svg, Not(HasSubstr("✗</text></g>")));
  EXPECT_THAT(svg, HasSubstr("time.step, s"));
}

}  // namespace
}  // namespace taut
