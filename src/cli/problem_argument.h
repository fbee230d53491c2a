#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "problems/read_scene.h"

namespace taut {

/// A file, or else the name of a problem in the catalogue. Throws UsageError where it is neither.
std::filesystem::path find_problem(const std::string& problem);

/// What --set was given: texts KEY=VALUE. Throws UsageError for others.
Overrides parse_settings(const std::vector<std::string>& settings);

}  // namespace taut
