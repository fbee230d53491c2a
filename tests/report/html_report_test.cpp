#include "report/html_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;
using testing::Not;

Json sample() {
  return Json::parse(R"json({
    "title": "cloth </title><b> & \"quotes\"",
    "command": "taut solve x --set 'a=</script><script>alert(1)</script>'",
    "version": "0.1.0", "machine": {"cpu": "one"}, "summary": ["A sentence <!-- with marks."],
    "charts": [{"id": "work", "title": "a < b", "x": {"label": "seconds", "log": true}, "y": {"label": "error", "log": true},
                "series": [{"name": "one & only", "line": true, "points": [
                  {"x": 0.1, "y": 1e-3, "status": "solved"}, {"x": 1, "y": null, "status": "stalled"},
                  {"x": 2, "y": 0, "status": "solved"}]}],
                "front": [[0.1, 1e-3], [2, 1e-9]]}],
    "heat_maps": [{"id": "map", "title": "map", "knob": "penalty", "values": ["1", "2"], "methods": ["m"],
                   "cells": [[{"outcome": "solved", "text": ""}, {"outcome": "crash", "text": "why"}]]}],
    "tables": [{"id": "t", "title": "t", "columns": ["a", "b"], "rows": [["x", 1], [null, 2]]}]
  })json");
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++found;
  return found;
}

class HtmlReport : public FilesTest {
 protected:
  void SetUp() override {
    if (!has_report_page()) GTEST_SKIP() << "built without node and npm";
  }
  std::string page(const Json& report) const {
    write_html_report(path("out"), report);
    return read_bytes(path("out") / "index.html");
  }
  std::string refusal(const Json& report) const {
    return message_of<std::invalid_argument>([&] { write_html_report(path("out"), report); });
  }
};

TEST_F(HtmlReport, NoTextOfAReportIsTakenForMarkup) {
  const std::string plain = page({{"title", "t"}}), text = page(sample());
  EXPECT_EQ(count(text, "</script>"), count(plain, "</script>"));
  EXPECT_EQ(count(text, "<!--"), count(plain, "<!--"));
  EXPECT_THAT(text, HasSubstr("<title>cloth &lt;/title&gt;&lt;b&gt; &amp; &quot;quotes&quot;</title>"));
}

TEST_F(HtmlReport, TheJsonInThePageIsTheReport) {
  const std::string text = page(sample()), opening = "<script type=\"application/json\" id=\"report\">";
  const std::size_t begin = text.find(opening) + opening.size();
  EXPECT_EQ(Json::parse(text.substr(begin, text.find("</script>", begin) - begin)), sample());
}

TEST_F(HtmlReport, TextThatIsNoUtf8StillGivesAPage) {
  Json report = sample();
  report["summary"] = {std::string("\xff\xfe broken")};
  EXPECT_THAT(page(report), HasSubstr("broken"));
}

TEST_F(HtmlReport, ThePageNamesNoPlaceToLoadAnythingFrom) {
  const std::string text = page(sample());
  EXPECT_THAT(text, HasSubstr("Content-Security-Policy\" content=\"default-src 'none'"));
  for (const char* loads : {"<script src", "<link rel=\"stylesheet", "@import", "<img src=\"http"})
    EXPECT_THAT(text, Not(HasSubstr(loads)));
}

TEST_F(HtmlReport, HoldsTheLicencesOfItsLibraries) {
  const std::string text = page(sample());
  EXPECT_GE(count(text, "Permission is hereby granted, free of charge"), 2u);
  EXPECT_THAT(text, HasSubstr("three.js authors"));
  EXPECT_THAT(text, HasSubstr("Leon Sorokin"));
}

TEST_F(HtmlReport, EachChartAndMapHasAnSvgBesideThePage) {
  const auto files = write_html_report(path("out"), sample());
  EXPECT_THAT(files,
              testing::ElementsAre(path("out") / "index.html", path("out") / "work.svg", path("out") / "map.svg"));
  const std::string chart = read_bytes(files[1]), map = read_bytes(files[2]);
  EXPECT_EQ(count(chart, "<circle"), 3u);
  EXPECT_EQ(count(chart, "fill=\"white\" stroke"), 1u) << "the point that is not solved is hollow";
  EXPECT_THAT(chart, HasSubstr("one &amp; only"));
  EXPECT_THAT(chart, HasSubstr("Pareto front"));
  EXPECT_THAT(map, HasSubstr("crash"));
  EXPECT_EQ(count(map, "<rect"), 1u + 2 + 2) << "the ground, the cells, the legend";
}

TEST_F(HtmlReport, APartThatIsMissingOrDoesNotFitIsNamed) {
  Json report = sample();
  report["charts"][0].erase("series");
  EXPECT_THAT(refusal(report), HasSubstr("series"));
  report = sample();
  report["charts"][0]["id"] = "../elsewhere";
  EXPECT_THAT(refusal(report), HasSubstr("'../elsewhere' must be made of letters"));
  report = sample();
  report["heat_maps"][0]["cells"][0][0]["outcome"] = "splendid";
  EXPECT_THAT(refusal(report), HasSubstr("there is no outcome 'splendid'"));
  report = sample();
  report["tables"][0]["rows"][1] = {1};
  EXPECT_THAT(refusal(report), HasSubstr("a row of table 't' has 1 cells, expected 2"));
}

}  // namespace
}  // namespace taut
