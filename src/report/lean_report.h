#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "study/lean.h"

namespace taut {

/// What a person reads first: the model found, its error and its cost beside the full scene's, and every reservation.
std::vector<std::string> lean_words(const LeanStudy& study);

/// Words, the table of models, what was left out or kept and why; `folder` is empty where nothing is kept.
std::string lean_terminal(const LeanStudy& study, const std::string& folder);

/// The same for write_html_report(), with the Pareto chart of error against seconds.
nlohmann::json lean_report(const LeanStudy& study, const std::string& command);

/// What of a scene could go, for a terminal.
std::string lean_check_terminal(const LeanStudy& study);

}  // namespace taut
