#include "report/heat_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "files/xml.h"

namespace taut {
namespace {

using Json = nlohmann::json;

struct Look {
  const char *outcome, *colour, *ink, *letter, *words;
};
// Told apart without colour by the letters.
constexpr std::array<Look, 6> looks{{{"solved", "#2a788e", "white", "", "solved"},
                                     {"honest_failure", "#f4d58d", "#333333", "h", "honest failure"},
                                     {"false_success", "#c1121f", "white", "F", "false success"},
                                     {"crash", "#1b1b1b", "white", "C", "crash"},
                                     {"timeout", "#9a8c98", "white", "t", "time-out"},
                                     {"not_applicable", "#eeeeee", "#888888", "–", "does not apply"}}};

const Look& look_of(const std::string& outcome) {
  return *std::find_if(looks.begin(), looks.end() - 1, [&](const Look& look) { return look.outcome == outcome; });
}

constexpr int row_height = 24, top = 56, names = 180, margin = 16;

}  // namespace

std::string heat_map_svg(const Json& heat_map) {
  const auto methods = heat_map.at("methods").get<std::vector<std::string>>();
  const auto values = heat_map.at("values").get<std::vector<std::string>>();
  std::size_t longest = 4;
  for (const std::string& value : values) longest = std::max(longest, value.size());
  const int column = static_cast<int>(8 * longest) + 14;
  const int bottom = top + row_height * static_cast<int>(methods.size());
  const int width = std::max(names + column * static_cast<int>(values.size()) + margin, 730), height = bottom + 72;
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
                 "font-family=\"sans-serif\" font-size=\"13\"><rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n"
                 "<text x=\"{2}\" y=\"24\" font-size=\"16\">{3}</text>\n"
                 "<text x=\"{4}\" y=\"{5}\">{6}</text>\n",
                 width, height, margin, xml_escaped(heat_map.at("title").get<std::string>()), names, bottom + 36,
                 xml_escaped(heat_map.at("knob").get<std::string>()));
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const int y = top + row_height * static_cast<int>(m);
    fmt::format_to(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", names - 8, y + 17,
                   xml_escaped(methods[m]));
    for (std::size_t v = 0; v < values.size(); ++v) {
      const Json& cell = heat_map.at("cells").at(m).at(v);
      const Look& look = look_of(cell.at("outcome"));
      const int x = names + column * static_cast<int>(v);
      fmt::format_to(out,
                     "<g><title>{}</title><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>"
                     "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" fill=\"{}\">{}</text></g>\n",
                     xml_escaped(cell.at("text").get<std::string>()), x, y, column - 2, row_height - 2, look.colour,
                     x + column / 2 - 1, y + 16, look.ink, look.letter);
    }
  }
  for (std::size_t v = 0; v < values.size(); ++v)
    fmt::format_to(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                   names + column * static_cast<int>(v) + column / 2 - 1, bottom + 16, xml_escaped(values[v]));
  int x = margin;
  for (const Look& look : looks) {
    fmt::format_to(out,
                   "<rect x=\"{}\" y=\"{}\" width=\"14\" height=\"14\" fill=\"{}\"/><text x=\"{}\" y=\"{}\" "
                   "text-anchor=\"middle\" font-size=\"11\" fill=\"{}\">{}</text><text x=\"{}\" y=\"{}\">{}</text>\n",
                   x, bottom + 48, look.colour, x + 7, bottom + 59, look.ink, look.letter, x + 20, bottom + 60,
                   look.words);
    x += 118;
  }
  return text + "</svg>\n";
}

}  // namespace taut
