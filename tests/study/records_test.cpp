#include "study/records.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "study/records_json.h"

namespace taut {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

StepRecord record(int step, double stationarity, Status status = Status::solved) {
  StepRecord record;
  record.step = step;
  record.status = status;
  record.message = "why";
  record.residuals.stationarity = stationarity;
  record.residuals.violations = {{"limit", stationarity / 3, "triangle 7 of cloth", 7}};
  record.penetrations = {{"ball", 0.1 * step, 0.2 / step}};
  record.counts.linear_solves = 10;
  record.seconds.total = 0.1;
  return record;
}

TEST(StepLine, ComesBack) {
  StepRecord written = record(3, nan, Status::stalled);
  written.residuals.violations.push_back({"ball", 0.1, "vertex 3 of cloth", 3});
  written.energies = {{"kinetic", 0.1 + 0.2}, {"a, \"b\"", nan}};
  written.penalties = {{"limit", 1e300}};
  const std::string line = step_line(written);
  EXPECT_EQ(step_line(parse_step(line)), line);
  EXPECT_THROW(parse_step(line.substr(1)), std::runtime_error);
  EXPECT_THROW(parse_step("{}"), std::runtime_error);
}

TEST(AddStep, KeepsTheWorstOfAllStepsAndSumsTheWork) {
  RunSummary summary;
  for (const StepRecord& r : {record(1, 1e-9), record(2, 1e-7), record(3, 1e-8)}) add_step(summary, r);
  EXPECT_EQ(summary.stationarity.scaled, 1e-7);
  EXPECT_EQ(summary.stationarity.step, 2);
  EXPECT_EQ(summary.violations.at(0).step, 2);
  EXPECT_EQ(summary.violations.at(1).penetration->edge, 0.1 * 3);
  EXPECT_EQ(summary.violations.at(1).penetration->face, 0.2);
  EXPECT_EQ(summary.counts.linear_solves, 30);
  EXPECT_EQ(summary.steps_solved, 3);
}

TEST(AddStep, ANanIsWorseThanAnyNumber) {
  RunSummary summary;
  for (const StepRecord& r : {record(1, 1e9), record(2, nan)}) add_step(summary, r);
  EXPECT_TRUE(std::isnan(summary.stationarity.scaled));
  EXPECT_EQ(summary.stationarity.step, 2);
}

TEST(AddStep, TheStatusIsThatOfTheFirstStepThatIsNotSolved) {
  RunSummary summary;
  for (const StepRecord& r : {record(1, 0), record(2, 1, Status::infeasible), record(3, 1, Status::stalled)})
    add_step(summary, r);
  EXPECT_EQ(summary.status, Status::infeasible);
  EXPECT_EQ(summary.message, "step 2: why");
  EXPECT_EQ(summary.steps_done, 3);
  EXPECT_EQ(summary.steps_solved, 1);
}

TEST(SummaryText, ReadsBackToTheLastBit) {
  RunSummary summary;
  summary.input_hash = "0123456789abcdef";
  summary.problem = "a \"quoted\" name";
  summary.objective = 0.1 + 0.2;
  summary.steps_asked = 5;
  summary.notes = {"note"};
  summary.worst_elements = {{"limit", "triangle 7 of cloth", 1.0 / 3}};
  summary.unfinished = UnfinishedStep{4, "stopped", 1e-300, 2, 3};
  summary.machine = {"cpu", "os", 2};
  add_step(summary, record(1, 1e-7 / 3));
  const std::string text = summary_text(summary);
  const RunSummary again = parse_summary(text);
  EXPECT_EQ(summary_text(again), text);
  EXPECT_EQ(again.objective, summary.objective);
  EXPECT_EQ(again.unfinished->stationarity, 1e-300);
  EXPECT_EQ(again.violations.at(0).penetration.has_value(), summary.violations.at(0).penetration.has_value());
}

TEST(SummaryText, IsJsonEvenWhereNumbersAreNot) {
  RunSummary summary;
  add_step(summary, record(1, nan, Status::not_finite));
  summary.objective = std::numeric_limits<double>::infinity();
  const auto json = nlohmann::json::parse(summary_text(summary));
  EXPECT_TRUE(json["objective"].is_null());
  EXPECT_TRUE(json["residuals"]["stationarity"].is_null());
  EXPECT_TRUE(std::isnan(parse_summary(summary_text(summary)).stationarity.scaled));
}

TEST(SummaryText, OtherTextIsRefused) {
  EXPECT_THROW(parse_summary("{}"), std::runtime_error);
  EXPECT_THROW(parse_summary("{\"format\": 99}"), std::runtime_error);
  EXPECT_THROW(parse_summary("not json"), std::runtime_error);
}

TEST(StepLine, IsOneLineThatNamesTheTriangleAndThePenetration) {
  StepRecord step = record(3, nan);
  step.message = "two\nlines";
  const std::string line = step_line(step);
  EXPECT_EQ(line.find('\n'), line.npos);
  const auto json = nlohmann::json::parse(line);
  EXPECT_EQ(json["violations"]["limit"]["where"], "triangle 7 of cloth");
  EXPECT_EQ(json["violations"]["ball"]["edge_penetration"], 0.1 * 3);
  EXPECT_TRUE(json["residuals"]["stationarity"].is_null());
}

}  // namespace
}  // namespace taut
