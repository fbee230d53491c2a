#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include "cli/commands.h"

namespace taut {

/// A folder that is removed again.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "taut_XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw std::runtime_error("cannot make a temporary directory");
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The folder of --out, or, where none was given, one that is removed again.
class OutFolder {
 public:
  /// Throws UsageError where an earlier `what` ("chart") cannot be gone on with, because its folder is not named.
  OutFolder(const std::string& out, bool resume, const std::string& what) : path_(out) {
    if (resume && out.empty())
      throw UsageError("--resume needs --out DIR, the directory of the " + what + " to go on with");
    if (out.empty()) path_ = temporary_.emplace().path();
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::optional<TemporaryFolder> temporary_;
  std::filesystem::path path_;
};

}  // namespace taut
