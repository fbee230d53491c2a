#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "files/file_error.h"

namespace taut {

/// All that a run needs to go on with the same bits. Doubles are kept in 64 bits, NaNs with their payload.
struct Checkpoint {
  std::string input_hash;  ///< of the problem it belongs to
  std::int64_t step = 0;   ///< the last finished step
  std::map<std::string, std::vector<double>> arrays;
  std::map<std::string, std::string> texts;
};

/// Replaces the checkpoint atomically: a crash in the middle leaves the previous one. Throws FileError.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Throws FileError where the file is missing, is no checkpoint, is of another version, is cut short, or fails its
/// CRC-32.
Checkpoint read_checkpoint(const std::filesystem::path& path);

}  // namespace taut
