#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "study/compare_records.h"

namespace taut {

/// The report (html_report.h) of a comparison: for each problem accuracy against time, time and residual step by step,
/// a heat map of what became of each step, and the table of compare.md. `command` is what made the comparison; every
/// entry has one that repeats it alone.
nlohmann::json compare_report(const Comparison& comparison, const std::string& command);

}  // namespace taut
