#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "study/chart_records.h"

namespace taut {

/// A chart as what the report shows: words, charts with a point per run (a failure stays in, without an error its y is
/// null), tables. `command` is what was typed.
nlohmann::json chart_report(const ChartData& chart, const std::string& command);

}  // namespace taut
