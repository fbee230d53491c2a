#pragma once

#include <filesystem>

#include "study/compare_records.h"

namespace taut {

/// The folder that a comparison writes to: compare.json, and a folder per problem with one per entry.
class CompareFolder {
 public:
  /// Only looks. Throws RunRefused for a folder that is neither missing, nor empty, nor a comparison's.
  CompareFolder(std::filesystem::path path, bool resume);

  const std::filesystem::path& path() const { return path_; }
  /// Writes compare.json with what is planned, and removes an earlier comparison unless it is resumed. Throws
  /// RunRefused where the folder cannot be made, FileError.
  void begin(const Comparison& comparison);
  /// Replaces compare.json. Throws FileError.
  void write(const Comparison& comparison) const;

 private:
  std::filesystem::path path_;
  bool resume_;
  std::vector<std::string> earlier_;  // folders of the problems of an earlier comparison
};

}  // namespace taut
