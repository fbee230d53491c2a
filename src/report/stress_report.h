#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "study/stress.h"

namespace taut {

/// The atlas as a report (report/html_report.h): a heat map per entry, the tables of methods, frontiers and losses.
/// `command` is what made it.
nlohmann::json stress_report(const StressAtlas& atlas, const std::string& command);

/// Frontiers, methods and losses for a terminal. `folder` is where files are; empty: nowhere.
std::string stress_terminal(const StressAtlas& atlas, const std::string& folder);

/// The same as a page of Markdown (stress.md).
std::string stress_markdown(const StressAtlas& atlas);

}  // namespace taut
