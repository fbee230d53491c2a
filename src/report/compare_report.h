#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "study/compare_records.h"

namespace taut {

/// The report (html_report.h) of a comparison: for each problem error against time with the Pareto front, residual
/// against time, time and residual step by step, a heat map of what became of each step, and the table of compare.md;
/// and a viewer of the first problem as the reference solved it, coloured also by how far other entries end from it.
/// `command` is what made the comparison; every entry has one that repeats it alone. `folder` holds what compare() has
/// written. Throws FileError where solutions in it are damaged.
nlohmann::json compare_report(const Comparison& comparison, const std::string& command,
                              const std::filesystem::path& folder);

}  // namespace taut
