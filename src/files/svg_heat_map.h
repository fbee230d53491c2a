#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "files/file_error.h"

namespace taut {

/// A grid of coloured cells with a sign in each.
struct HeatMap {
  struct Cell {
    std::string colour, sign;
    std::string note = {};  ///< shown under the pointer
  };
  struct Kind {
    Cell cell;
    std::string meaning;
  };
  std::string title, column_name;
  std::vector<std::string> columns, rows;
  std::vector<std::vector<Cell>> cells;  ///< cells[row][column]
  std::vector<Kind> legend;
};

/// Writes the map atomically as a self-contained SVG. Throws std::invalid_argument where cells are missing, FileError.
void write_heat_map(const std::filesystem::path& path, const HeatMap& map);

}  // namespace taut
