#include "files/json_lines.h"

#include <fcntl.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace taut {
namespace {

int open_flags(long lines) {
  if (lines < 0) throw std::invalid_argument("LineFile: lines must be at least 0, got " + std::to_string(lines));
  return O_RDWR | O_APPEND | (lines == 0 ? O_CREAT : 0);
}

/// The number of bytes in the first `lines` complete lines.
std::int64_t length_of_lines(Descriptor& file, const std::filesystem::path& path, long lines) {
  std::vector<char> chunk(1 << 16);
  std::int64_t offset = 0;
  long found = 0;
  while (found < lines) {
    const std::size_t count = file.read(chunk.data(), chunk.size());
    if (count == 0) {
      throw FileError(
          path, "has " + std::to_string(found) + " complete lines where " + std::to_string(lines) + " are needed");
    }
    std::size_t i = 0;
    while (i < count && found < lines) found += chunk[i++] == '\n';
    offset += static_cast<std::int64_t>(i);
  }
  return offset;
}

}  // namespace

LineFile::LineFile(const std::filesystem::path& path, long lines)
    : file_(path, open_flags(lines)), size_(length_of_lines(file_, path, lines)) {
  file_.truncate(size_);
}

void LineFile::append(std::string_view line) {
  if (line.find('\n') != std::string_view::npos) {
    throw std::invalid_argument("LineFile::append: line must be one line, got one with a line break");
  }
  std::string bytes(line);
  bytes += '\n';
  try {
    file_.write(bytes);
  } catch (const FileError&) {
    file_.truncate(size_);
    throw;
  }
  size_ += static_cast<std::int64_t>(bytes.size());
}

}  // namespace taut
