#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "files/file_error.h"

namespace taut {

/// Replaces the file by `bytes` so that a reader, or a restart after a crash, finds the old content or the new, never a
/// mixture. The bytes go to `<path>.partial` beside it first, are forced to disk and renamed. Throws FileError.
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

/// The whole content of a file. Throws FileError.
std::string read_bytes(const std::filesystem::path& path);

}  // namespace taut
