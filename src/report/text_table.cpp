#include "report/text_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace taut {

std::string aligned(const TextTable& table) {
  std::vector<std::size_t> widths(table.front().size(), 0);
  for (const std::vector<std::string>& row : table) {
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::string text;
  for (const std::vector<std::string>& row : table) {
    std::string line;
    for (std::size_t k = 0; k < row.size(); ++k) line += fmt::format("{:<{}}  ", row[k], widths[k]);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

std::string markdown(const TextTable& table) {
  std::string text;
  for (std::size_t k = 0; k < table.size(); ++k) {
    text += fmt::format("| {} |\n", fmt::join(table[k], " | "));
    if (k == 0) text += fmt::format("|{}\n", fmt::join(std::vector<std::string>(table[k].size(), "---|"), ""));
  }
  return text;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

}  // namespace taut
