#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "files/descriptor.h"
#include "files/file_error.h"

namespace taut {

/// A file of text lines (steps.jsonl) that only grows. A line that `append` has returned from survives the death of the
/// process.
class LineFile {
 public:
  /// Keeps exactly the first `lines` complete lines, as a resumed run needs it, and drops what follows, a half-written
  /// line included. With 0 the file begins empty, and is created where it is missing. Throws FileError where fewer
  /// complete lines exist (the file is then left as it was), std::invalid_argument for a negative number.
  explicit LineFile(const std::filesystem::path& path, long lines = 0);

  /// Writes the line and a '\n'. Throws std::invalid_argument where `line` contains a '\n'; FileError (disk full), with
  /// the file as before.
  void append(std::string_view line);
  /// Forces the lines to disk: call it before a checkpoint that counts on them, so that both survive a power cut.
  void sync() { file_.sync(); }

 private:
  Descriptor file_;
  std::int64_t size_;  ///< bytes of complete lines
};

}  // namespace taut
