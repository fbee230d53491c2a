#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "problems/read_scene.h"

namespace taut {

/// The problem file that PROBLEM names: a file, or else a problem of the catalogue. Throws UsageError where neither is
/// there.
std::filesystem::path find_problem(const std::string& problem);

/// The values of --set, each KEY=VALUE. Throws UsageError for anything else.
Overrides parse_settings(const std::vector<std::string>& settings);

/// Makes the folder that --out names, and those above it. Throws UsageError where that cannot be.
void make_folder(const std::string& path);

}  // namespace taut
