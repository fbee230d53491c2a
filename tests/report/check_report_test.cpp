#include "report/check_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace taut {
namespace {

using testing::HasSubstr;

/// `frames` frames whose violation of a limit grows, the later the larger.
CheckReport sample(int frames) {
  CheckReport report;
  report.problem = "cloth";
  report.tolerance = 1e-6;
  for (int i = 1; i <= frames; ++i) {
    const double value = 1e-3 * i;
    report.frames.push_back(
        {"f, " + std::to_string(i), i, 0.1 * i, {{"limit", value, value / 2, 1e-6, 32, 1, "triangle 3 of cloth"}}});
  }
  take_worst(report, 0);
  return report;
}

TEST(CheckReport, TheWorstOfAllFramesIsKeptWithItsPlace) {
  const CheckReport report = sample(3);
  ASSERT_EQ(report.worst.size(), 1u);
  EXPECT_EQ(report.worst[0].max, 3e-3);
  EXPECT_EQ(report.worst[0].percentile99, 1.5e-3);
  EXPECT_EQ(report.worst[0].where, "triangle 3 of cloth, frame 3");
  EXPECT_EQ(report.worst[0].violated, 3);
  EXPECT_DOUBLE_EQ(report.worst[0].share(), 3.0 / 96);
  EXPECT_THAT(report.findings, testing::ElementsAre("limit: 0.003 at triangle 3 of cloth, frame 3, allowed is 1e-06; "
                                                    "violated in 3 of 3 frames"));
}

TEST(CheckReport, WhatCannotBeJudgedOutweighsWhatIsViolated) {
  CheckReport report = sample(1);
  EXPECT_EQ(report.verdict(), CheckVerdict::outside);
  report.unusable = {"f.obj: is missing"};
  EXPECT_EQ(report.verdict(), CheckVerdict::unusable);
  EXPECT_EQ(CheckReport().verdict(), CheckVerdict::within);
}

TEST(CheckTable, ListsTheWorstFramesFirstAndNotAllOfMany) {
  const std::string table = check_table(sample(50));
  EXPECT_LT(table.find("      50 "), table.find("      49 "));
  EXPECT_THAT(table, HasSubstr("and 30 more frames"));
  EXPECT_THAT(table, HasSubstr("cloth: , not within tolerance"));
}

TEST(CheckTable, ListsNotAllOfManyFindings) {
  CheckReport report;
  report.unusable.assign(25, "f.obj: is missing");
  EXPECT_THAT(check_table(report), HasSubstr("and 5 more (--json has all)"));
}

TEST(CheckCsv, HasALineForEachFrameAndConstraint) {
  EXPECT_EQ(check_csv(sample(2)),
            "file,number,time,constraint,max,percentile99,allowed,violated,elements,share,where\n"
            "\"f, 1\",1,0.1,\"limit\",0.001,0.0005,1e-06,1,32,0.03125,\"triangle 3 of cloth\"\n"
            "\"f, 2\",2,0.2,\"limit\",0.002,0.001,1e-06,1,32,0.03125,\"triangle 3 of cloth\"\n");
}

TEST(CheckJson, HoldsEverythingAndNullForWhatIsNotFinite) {
  CheckReport report = sample(2);
  report.frames[0].verdicts[0].max = std::numeric_limits<double>::infinity();
  const auto json = nlohmann::json::parse(check_json(report));
  EXPECT_EQ(json["verdict"], "not within tolerance");
  EXPECT_TRUE(json["frames"][0]["constraints"]["limit"]["max"].is_null());
  EXPECT_EQ(json["frames"][1]["constraints"]["limit"]["max"], 2e-3);
  EXPECT_EQ(json["worst"]["limit"]["violated"], 2);
  EXPECT_TRUE(json["last_step"].is_null());
}

}  // namespace
}  // namespace taut
