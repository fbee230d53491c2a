#include "report/html_report.h"

#include <fmt/format.h>

#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>

#include "files/atomic_file.h"
#include "files/svg_chart.h"
#include "files/svg_heat_map.h"
#include "files/xml.h"
#include "study/frame_output.h"

namespace taut {

extern const char* const report_page_text;  // empty where it was not built

namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;

/// Colours and signs as in page.css and heat_map.js.
const std::map<std::string, HeatMap::Kind> outcomes{{"solved", {{"#2a788e", "✓"}, "solved"}},
                                                    {"honest_failure", {{"#8a94a2", "○"}, "not solved, and says so"}},
                                                    {"false_success", {{"#c8324a", "✗"}, "says solved, is not"}},
                                                    {"crash", {{"#7a1f2b", "!"}, "crash"}},
                                                    {"timeout", {{"#b07d00", "…"}, "out of time"}},
                                                    {"not_applicable", {{"#ffffff", ""}, "does not apply"}}};

/// JSON inside a script element: there "</script>" and "<!--" end or change it even within a string.
std::string script_text(const Json& json) {
  const std::string plain = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  text.reserve(plain.size());
  for (const char c : plain) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string page_of(const Json& report) {
  const std::string_view page = report_page_text, title_mark = "@TITLE@", report_mark = "@REPORT@";
  const std::size_t title = page.find(title_mark), data = page.find(report_mark);
  if (title == page.npos || data == page.npos || data < title)
    throw std::logic_error("the report's page lacks its marks");
  std::string text(page.substr(0, title));
  text += xml_escaped(report.at("title").get<std::string>());
  text += page.substr(title + title_mark.size(), data - title - title_mark.size());
  text += script_text(report);
  return text.append(page.substr(data + report_mark.size()));
}

Chart::Axis axis_of(const Json& axis) { return {axis.at("label"), axis.value("log", false)}; }

Chart chart_of(const Json& json) {
  constexpr std::size_t most_marks = 60;  // curves with more points are told apart without
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Chart chart;
  chart.title = json.at("title");
  chart.x = axis_of(json.at("x"));
  chart.y = axis_of(json.at("y"));
  for (const Json& series : json.at("series")) {
    Chart::Line& line = chart.lines.emplace_back();
    line.name = series.at("name");
    line.joined = series.value("line", false);
    const Json& points = series.at("points");
    const bool marked = points.size() <= most_marks;
    for (const Json& point : points) {
      if (!point.at("x").is_number()) continue;
      line.x.push_back(point["x"]);
      line.y.push_back(point.at("y").is_number() ? point["y"].get<double>() : infinity);
      if (marked)
        line.marks.push_back(point.value("status", "solved") == "solved" ? Chart::Mark::filled : Chart::Mark::hollow);
    }
  }
  if (json.contains("front")) chart.front = json["front"].get<std::vector<std::array<double, 2>>>();
  return chart;
}

HeatMap heat_map_of(const Json& json) {
  HeatMap map{json.at("title"), json.at("knob"), json.at("values"), json.at("methods"), {}, {}};
  std::set<std::string> present;
  for (const Json& row : json.at("cells")) {
    auto& cells = map.cells.emplace_back();
    for (const Json& cell : row) {
      const std::string outcome = cell.at("outcome");
      if (!outcomes.contains(outcome)) throw std::invalid_argument("report: there is no outcome '" + outcome + "'");
      cells.push_back(outcomes.at(outcome).cell);
      cells.back().note = cell.value("text", "");
      if (present.insert(outcome).second) map.legend.push_back(outcomes.at(outcome));
    }
  }
  return map;
}

void check_table(const Json& table) {
  const std::size_t columns = table.at("columns").size();
  for (const Json& row : table.at("rows")) {
    if (row.size() != columns)
      throw std::invalid_argument(fmt::format("report: a row of table '{}' has {} cells, expected {}",
                                              table.at("id").get<std::string>(), row.size(), columns));
  }
}

/// The SVG of a part; the page links to it by the same name.
fs::path picture_path(const fs::path& folder, const Json& part) {
  const std::string id = part.at("id");
  if (id != file_name(id))
    throw std::invalid_argument("report: '" + id + "' must be made of letters, digits, '.', '-' and '_'");
  return folder / (id + ".svg");
}

}  // namespace

bool has_report_page() { return *report_page_text != '\0'; }

std::vector<fs::path> write_report_pictures(const fs::path& folder, const Json& report) try {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw FileError(folder, "cannot be created: " + error.message());
  std::vector<fs::path> files;
  for (const Json& chart : report.value("charts", Json::array())) {
    files.push_back(picture_path(folder, chart));
    write_chart(files.back(), chart_of(chart));
  }
  for (const Json& map : report.value("heat_maps", Json::array())) {
    files.push_back(picture_path(folder, map));
    write_heat_map(files.back(), heat_map_of(map));
  }
  return files;
} catch (const Json::exception& error) {
  throw std::invalid_argument(std::string("report: ") + error.what());
}

std::vector<fs::path> write_html_report(const fs::path& folder, const Json& report) try {
  if (!has_report_page())
    throw std::runtime_error("this build has no page for reports: npm was missing when it was built");
  std::vector<fs::path> files = write_report_pictures(folder, report);
  for (const Json& table : report.value("tables", Json::array())) check_table(table);
  files.insert(files.begin(), folder / "index.html");
  write_atomically(files.front(), page_of(report));
  return files;
} catch (const Json::exception& error) {
  throw std::invalid_argument(std::string("report: ") + error.what());
}

}  // namespace taut
