#pragma once

#include <string>
#include <vector>

namespace taut {

/// A table: rows of one size, the first with the names of the columns.
using TextTable = std::vector<std::vector<std::string>>;

/// For a terminal: columns aligned by spaces.
std::string aligned(const TextTable& table);
/// A table of Markdown.
std::string markdown(const TextTable& table);
/// A text as a cell of a CSV file, in quotes.
std::string quoted(const std::string& text);

}  // namespace taut
