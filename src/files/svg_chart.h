#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "files/file_error.h"

namespace taut {

/// Lines over one axis.
struct Chart {
  struct Line {
    std::string name;
    std::vector<double> x, y;  ///< of one size; points that are not finite interrupt the line
  };
  std::string title, x_name, y_name;
  std::vector<Line> lines;    ///< at most six are told apart
  std::vector<double> marks;  ///< places on the x axis that get a tick of their own: losses
  std::string marks_name;
};

/// Writes the chart atomically as a self-contained SVG with axes from the data and a legend. Throws FileError.
void write_chart(const std::filesystem::path& path, const Chart& chart);

}  // namespace taut
