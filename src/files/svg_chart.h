#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "files/file_error.h"

namespace taut {

/// Lines and marks over two axes.
struct Chart {
  enum class Mark { none, filled, hollow };
  struct Axis {
    std::string name;
    bool logarithmic = false;
  };
  struct Line {
    std::string name;
    std::vector<double> x, y;  ///< of one size; points that are not finite interrupt the line
    bool joined = true;        ///< by a line
    std::vector<Mark> marks;   ///< one per point, or none at all
  };
  std::string title;
  Axis x, y;
  std::vector<Line> lines;    ///< at most ten are told apart
  std::vector<double> ticks;  ///< places on the x axis that get a tick of their own: losses
  std::string ticks_name;
  std::vector<std::array<double, 2>> front;  ///< joined by a dashed line: the Pareto front
};

/// Writes the chart atomically as a self-contained SVG with axes from the data and a legend. What an axis cannot show
/// stands at its edge: y = infinity at the top, zero on a logarithmic axis at its lower end. Throws FileError.
void write_chart(const std::filesystem::path& path, const Chart& chart);

}  // namespace taut
