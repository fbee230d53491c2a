#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace taut {

/// The report (html_report.h) of the run in `folder`: residuals, violations, energies, cost and probes step by step,
/// what is worst and where, and the viewer. `command` is what made the run. Throws as read_stored_run() and
/// viewer_data() do.
nlohmann::json run_report(const std::filesystem::path& folder, const std::string& command);

}  // namespace taut
