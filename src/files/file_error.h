#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace taut {

/// A file that cannot be read, written or trusted. The message is one line that begins with the path.
class FileError : public std::runtime_error {
 public:
  FileError(const std::filesystem::path& path, const std::string& problem)
      : std::runtime_error(path.string() + ": " + problem) {}
};

}  // namespace taut
