#include "files/atomic_file.h"

#include <fcntl.h>

#include <system_error>
#include <vector>

#include "files/descriptor.h"

namespace taut {

void write_atomically(const std::filesystem::path& path, std::string_view bytes) {
  std::filesystem::path partial = path;
  partial += ".partial";
  std::error_code error;
  try {
    Descriptor file(partial, O_WRONLY | O_CREAT | O_TRUNC);
    file.write(bytes);
    file.sync();
  } catch (const FileError&) {
    std::filesystem::remove(partial, error);
    throw;
  }
  std::filesystem::rename(partial, path, error);
  if (error) throw FileError(path, "cannot replace: " + error.message());
}

std::string read_bytes(const std::filesystem::path& path) {
  Descriptor file(path, O_RDONLY);
  std::string bytes;
  std::vector<char> chunk(1 << 20);
  while (const std::size_t count = file.read(chunk.data(), chunk.size())) bytes.append(chunk.data(), count);
  return bytes;
}

}  // namespace taut
