#include "files/svg_heat_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "files/atomic_file.h"
#include "files/xml.h"

namespace taut {
namespace {

constexpr double cell_width = 64, cell_height = 28, top = 84, letter = 7.5;  // of the picture's own units

void check(const HeatMap& map) {
  const auto is_full = [&map](const auto& row) { return row.size() == map.columns.size(); };
  if (map.cells.size() == map.rows.size() && std::all_of(map.cells.begin(), map.cells.end(), is_full)) return;
  throw std::invalid_argument(
      fmt::format("write_heat_map: cells must be {} rows of {} cells", map.rows.size(), map.columns.size()));
}

std::string drawn_cell(const HeatMap::Cell& cell, double x, double y) {
  const std::string note = cell.note.empty() ? "" : "<title>" + xml_escaped(cell.note) + "</title>";
  return fmt::format(
      "<g>{}<rect x=\"{:.0f}\" y=\"{:.0f}\" width=\"{}\" height=\"{}\" fill=\"{}\" stroke=\"white\"/><text "
      "x=\"{:.0f}\" "
      "y=\"{:.0f}\" text-anchor=\"middle\" fill=\"white\">{}</text></g>\n",
      note, x, y, cell_width, cell_height, xml_escaped(cell.colour), x + cell_width / 2, y + 19,
      xml_escaped(cell.sign));
}

}  // namespace

void write_heat_map(const std::filesystem::path& path, const HeatMap& map) {
  check(map);
  std::size_t longest = map.column_name.size(), meaning = 0;
  for (const std::string& row : map.rows) longest = std::max(longest, row.size());
  for (const auto& kind : map.legend) meaning = std::max(meaning, kind.meaning.size());
  const double left = 30 + letter * static_cast<double>(longest);
  const double grid = cell_width * static_cast<double>(map.columns.size());
  const double width = left + grid + cell_width + 50 + letter * static_cast<double>(meaning);
  const double height =
      top + (cell_height + 2) * static_cast<double>(std::max(map.rows.size(), map.legend.size())) + 30;

  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"13\"><rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
      "<text x=\"20\" y=\"30\" font-size=\"16\">{2}</text>\n<text x=\"20\" y=\"{3}\">{4}</text>\n",
      width, height, xml_escaped(map.title), top - 10, xml_escaped(map.column_name));
  const auto out = std::back_inserter(text);
  for (std::size_t j = 0; j < map.columns.size(); ++j) {
    fmt::format_to(out, "<text x=\"{:.0f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                   left + cell_width * (static_cast<double>(j) + 0.5), top - 10, xml_escaped(map.columns[j]));
  }
  for (std::size_t i = 0; i < map.rows.size(); ++i) {
    const double y = top + cell_height * static_cast<double>(i);
    fmt::format_to(out, "<text x=\"20\" y=\"{:.0f}\">{}</text>\n", y + 19, xml_escaped(map.rows[i]));
    for (std::size_t j = 0; j < map.columns.size(); ++j)
      text += drawn_cell(map.cells[i][j], left + cell_width * static_cast<double>(j), y);
  }
  for (std::size_t k = 0; k < map.legend.size(); ++k) {
    const double x = left + grid + 30, y = top + (cell_height + 2) * static_cast<double>(k);
    text += drawn_cell(map.legend[k].cell, x, y);
    fmt::format_to(out, "<text x=\"{:.0f}\" y=\"{:.0f}\">{}</text>\n", x + cell_width + 10, y + 19,
                   xml_escaped(map.legend[k].meaning));
  }
  write_atomically(path, text + "</svg>\n");
}

}  // namespace taut
