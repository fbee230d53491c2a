#include "files/svg_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "files/atomic_file.h"
#include "files/xml.h"

namespace taut {
namespace {

constexpr double width = 860, height = 460, left = 90, right = 30, top = 60, bottom = 70;
constexpr std::array colours{"#721f7f", "#f1605d", "#2a788e", "#b07d00", "#3b528b", "#555555"};

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();

  void take(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Room for something where there is nothing, or one value.
  void open() {
    if (!(low <= high)) low = 0, high = 1;
    if (low == high) high = low + (low == 0 ? 1 : std::abs(low));
  }
  /// A round distance between five or so ticks.
  double tick() const {
    const double raw = (high - low) / 5, power = std::pow(10.0, std::floor(std::log10(raw)));
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (raw <= factor * power) return factor * power;
    }
    return 10 * power;
  }
};

class Drawing {
 public:
  explicit Drawing(const Chart& chart) : chart_(chart) {
    for (const Chart::Line& line : chart.lines) {
      for (const double x : line.x) x_.take(x);
      for (const double y : line.y) y_.take(y);
    }
    y_.take(0);
    x_.open();
    y_.open();
  }

  std::string text() {
    write(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
        "font-family=\"sans-serif\" font-size=\"13\"><rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        width, height);
    write("<text x=\"{}\" y=\"26\" font-size=\"16\">{}</text>\n", left, xml_escaped(chart_.title));
    axes();
    lines();
    return svg_ + "</svg>\n";
  }

 private:
  template <class... Values>
  void write(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(svg_), format, std::forward<Values>(values)...);
  }
  double place_x(double x) const { return left + (x - x_.low) / (x_.high - x_.low) * (width - left - right); }
  double place_y(double y) const {
    return height - bottom - (y - y_.low) / (y_.high - y_.low) * (height - top - bottom);
  }

  void axes() {
    for (double x = std::ceil(x_.low / x_.tick()) * x_.tick(); x <= x_.high; x += x_.tick()) {
      write(
          "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3}\" "
          "text-anchor=\"middle\">{4:.4g}</text>\n",
          place_x(x), top, height - bottom, height - bottom + 20, x);
    }
    for (double y = std::ceil(y_.low / y_.tick()) * y_.tick(); y <= y_.high; y += y_.tick()) {
      write(
          "<path d=\"M{0} {1:.1f}H{2}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" "
          "text-anchor=\"end\">{5:.3g}</text>\n",
          left, place_y(y), width - right, left - 8, place_y(y) + 4, y);
    }
    write("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", (left + width - right) / 2, height - 28,
          xml_escaped(chart_.x_name));
    write("<text transform=\"translate(22 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
          (top + height - bottom) / 2, xml_escaped(chart_.y_name));
  }

  void lines() {
    for (const double mark : chart_.marks) {
      write("<path d=\"M{:.1f} {}v8\" stroke=\"#d00\" stroke-width=\"1.5\"/>\n", place_x(mark), height - bottom - 8);
    }
    double legend = left;
    if (!chart_.marks.empty()) legend_entry(legend, "#d00", chart_.marks_name);
    for (std::size_t k = 0; k < chart_.lines.size(); ++k) {
      const Chart::Line& line = chart_.lines[k];
      const char* colour = colours[k % colours.size()];
      std::string path;
      bool down = false;
      for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
        const bool finite = std::isfinite(line.x[i]) && std::isfinite(line.y[i]);
        if (finite) path += fmt::format("{}{:.1f} {:.1f}", down ? "L" : "M", place_x(line.x[i]), place_y(line.y[i]));
        down = finite;
      }
      write("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"/>\n", path, colour);
      legend_entry(legend, colour, line.name);
    }
  }

  void legend_entry(double& at, const char* colour, const std::string& name) {
    write("<path d=\"M{} 44h22\" stroke=\"{}\" stroke-width=\"3\"/><text x=\"{}\" y=\"48\">{}</text>\n", at, colour,
          at + 28, xml_escaped(name));
    at += 48 + 7.5 * static_cast<double>(name.size());
  }

  const Chart& chart_;
  Range x_, y_;
  std::string svg_;
};

}  // namespace

void write_chart(const std::filesystem::path& path, const Chart& chart) {
  write_atomically(path, Drawing(chart).text());
}

}  // namespace taut
