#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "study/chart_records.h"

namespace taut {

/// A chart as what the report shows: words, charts with a point per run (a failure stays in, without an error its y is
/// null), tables. `command` is what was typed.
nlohmann::json chart_report(const ChartData& chart, const std::string& command);

/// Writes FOLDER/ID.svg for each of the report's "charts" and returns the files. Throws FileError.
std::vector<std::filesystem::path> write_chart_pictures(const std::filesystem::path& folder,
                                                        const nlohmann::json& report);

}  // namespace taut
