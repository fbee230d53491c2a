#include "cli/arguments.h"

#include "cli/commands.h"

namespace taut {
namespace fs = std::filesystem;

fs::path find_problem(const std::string& problem) {
  std::error_code error;
  if (fs::is_regular_file(problem, error)) return problem;
  const bool is_name = problem.find('.') == problem.npos && !problem.starts_with('/');
  const fs::path listed = catalogue_folder() / (problem + ".json");
  if (is_name && fs::is_regular_file(listed, error)) return listed;
  throw UsageError(
      problem + (is_name ? ": no such file, and no problem of the catalogue (taut list problems)" : ": no such file"));
}

Overrides parse_settings(const std::vector<std::string>& settings) {
  Overrides overrides;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == setting.npos || equals == 0)
      throw UsageError("--set " + setting + ": expected KEY=VALUE, as in time.steps=10");
    overrides.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
  }
  return overrides;
}

void make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw UsageError(path + ": cannot be created: " + error.message());
}

}  // namespace taut
