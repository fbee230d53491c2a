#include "files/svg_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "files/atomic_file.h"
#include "files/xml.h"

namespace taut {
namespace {

constexpr double width = 1000, height = 460, left = 90, right = 270, top = 50, bottom = 70;
constexpr std::array colours{"#721f7f", "#d1453f", "#2a788e", "#b07d00", "#3b528b",
                             "#555555", "#1f8a4c", "#b0307a", "#7a5230", "#007fa3"};

/// The values of an axis, and where they are on it.
class Scale {
 public:
  explicit Scale(bool logarithmic) : logarithmic_(logarithmic) {}

  void take(double value) {
    if (!std::isfinite(value) || (logarithmic_ && value <= 0)) return;
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  /// Room for something where there is nothing, or one value.
  void open() {
    if (logarithmic_) {
      if (!(low_ <= high_)) low_ = 0.1, high_ = 10;
      if (low_ == high_) low_ /= 3, high_ *= 3;
    } else {
      if (!(low_ <= high_)) low_ = 0, high_ = 1;
      if (low_ == high_) high_ = low_ + (low_ == 0 ? 1 : std::abs(low_));
    }
  }
  /// From 0 at the lower end to 1 at the upper; what cannot be shown stands at an end.
  double place(double value) const {
    if (!logarithmic_) return std::clamp((value - low_) / (high_ - low_), 0.0, 1.0);
    return value <= 0 ? 0.0 : std::clamp(std::log(value / low_) / std::log(high_ / low_), 0.0, 1.0);
  }
  std::vector<double> ticks() const {
    std::vector<double> ticks;
    if (!logarithmic_ || high_ < 10 * low_) {
      const double step = round_step((high_ - low_) / 5);
      for (double i = std::ceil(low_ / step); i * step <= high_ * (1 + 1e-12); ++i) ticks.push_back(i * step);
      return ticks;
    }
    const int first = static_cast<int>(std::floor(std::log10(low_)));
    const int last = static_cast<int>(std::ceil(std::log10(high_)));
    for (int power = first; power <= last; power += std::max(1, (last - first + 7) / 8)) {
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double tick = factor * std::pow(10.0, power);
        if ((factor == 1 || last - first <= 2) && tick >= low_ && tick <= high_) ticks.push_back(tick);
      }
    }
    return ticks;
  }

 private:
  static double round_step(double raw) {
    const double power = std::pow(10.0, std::floor(std::log10(raw)));
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (raw <= factor * power) return factor * power;
    }
    return 10 * power;
  }

  bool logarithmic_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -std::numeric_limits<double>::infinity();
};

class Drawing {
 public:
  explicit Drawing(const Chart& chart) : chart_(chart), x_(chart.x.logarithmic), y_(chart.y.logarithmic) {
    for (const Chart::Line& line : chart.lines) {
      for (const double x : line.x) x_.take(x);
      for (const double y : line.y) y_.take(y);
    }
    for (const auto& [x, y] : chart.front) x_.take(x), y_.take(y);
    y_.take(0);  // on a linear axis
    x_.open();
    y_.open();
  }

  std::string text() {
    write(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
        "font-family=\"sans-serif\" font-size=\"13\"><rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        width, height);
    write("<text x=\"{}\" y=\"28\" font-size=\"16\">{}</text>\n", left, xml_escaped(chart_.title));
    axes();
    for (const double tick : chart_.ticks) {
      write("<path d=\"M{:.1f} {}v8\" stroke=\"#d00\" stroke-width=\"1.5\"/>\n", place_x(tick), height - bottom - 8);
    }
    if (!chart_.ticks.empty()) legend_entry("#d00", "", chart_.ticks_name);
    if (!chart_.front.empty()) front();
    for (std::size_t k = 0; k < chart_.lines.size(); ++k) line(chart_.lines[k], colours[k % colours.size()]);
    return svg_ + "</svg>\n";
  }

 private:
  template <class... Values>
  void write(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(svg_), format, std::forward<Values>(values)...);
  }
  double place_x(double x) const { return left + x_.place(x) * (width - left - right); }
  double place_y(double y) const { return height - bottom - y_.place(y) * (height - top - bottom); }
  static bool is_shown(double x, double y) { return std::isfinite(x) && !std::isnan(y); }

  void axes() {
    for (const double x : x_.ticks()) {
      write(
          "<path d=\"M{0:.1f} {1}V{2}\" stroke=\"#ddd\"/><text x=\"{0:.1f}\" y=\"{3}\" "
          "text-anchor=\"middle\">{4:.4g}</text>\n",
          place_x(x), top, height - bottom, height - bottom + 20, x);
    }
    for (const double y : y_.ticks()) {
      write(
          "<path d=\"M{0} {1:.1f}H{2}\" stroke=\"#ddd\"/><text x=\"{3}\" y=\"{4:.1f}\" "
          "text-anchor=\"end\">{5:.3g}</text>\n",
          left, place_y(y), width - right, left - 8, place_y(y) + 4, y);
    }
    write("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", (left + width - right) / 2, height - 28,
          xml_escaped(chart_.x.name));
    write("<text transform=\"translate(22 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
          (top + height - bottom) / 2, xml_escaped(chart_.y.name));
  }

  void front() {
    std::string path;
    for (const auto& [x, y] : chart_.front)
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", place_x(x), place_y(y));
    constexpr const char* dashes = " stroke-dasharray=\"7 5\"";
    write("<path d=\"{}\" fill=\"none\" stroke=\"#555\"{}/>\n", path, dashes);
    legend_entry("#555", dashes, "Pareto front");
  }

  void line(const Chart::Line& line, const char* colour) {
    const std::size_t points = std::min(line.x.size(), line.y.size());
    std::string path, marks;
    bool down = false;
    for (std::size_t i = 0; i < points; ++i) {
      const bool shown = is_shown(line.x[i], line.y[i]);
      if (shown) path += fmt::format("{}{:.1f} {:.1f}", down ? "L" : "M", place_x(line.x[i]), place_y(line.y[i]));
      down = shown;
      const Chart::Mark mark = i < line.marks.size() ? line.marks[i] : Chart::Mark::none;
      if (!shown || mark == Chart::Mark::none) continue;
      marks +=
          fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\" stroke=\"{}\"/>\n", place_x(line.x[i]),
                      place_y(line.y[i]), mark == Chart::Mark::hollow ? "white" : colour, colour);
    }
    if (line.joined) write("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.8\"/>\n", path, colour);
    svg_ += marks;
    legend_entry(colour, "", line.name);
  }

  void legend_entry(const char* colour, const char* dashes, const std::string& name) {
    const double x = width - right + 20;
    write("<path d=\"M{} {}h22\" stroke=\"{}\" stroke-width=\"3\"{}/><text x=\"{}\" y=\"{}\">{}</text>\n", x, legend_,
          colour, dashes, x + 30, legend_ + 4, xml_escaped(name));
    legend_ += 20;
  }

  const Chart& chart_;
  Scale x_, y_;
  double legend_ = top + 8;
  std::string svg_;
};

}  // namespace

void write_chart(const std::filesystem::path& path, const Chart& chart) {
  write_atomically(path, Drawing(chart).text());
}

}  // namespace taut
