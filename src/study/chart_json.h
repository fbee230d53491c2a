#pragma once

#include <string>

#include "study/chart_records.h"

namespace taut {

/// chart.json: everything. NaNs and infinities become null.
std::string chart_text(const ChartData& chart);

}  // namespace taut
