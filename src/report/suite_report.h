#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "study/suite.h"

namespace taut {

/// The table of the entries, with false successes and correct answers first, and what is worth a second look.
/// `folder`: where files are, empty for none.
std::string suite_terminal(const Suite& suite, const std::string& folder);
/// The same as Markdown, compare.md.
std::string suite_markdown(const Suite& suite);
/// A line per model and entry, compare.csv.
std::string suite_csv(const Suite& suite);
/// For html_report.h: performance profile, a map of what became of each model, tables.
nlohmann::json suite_report(const Suite& suite, const std::string& command);

}  // namespace taut
