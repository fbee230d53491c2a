#include "files/descriptor.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "files/file_error.h"

namespace taut {

Descriptor::Descriptor(const std::filesystem::path& path, int flags)
    : path_(path), descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail("open");
}

Descriptor::Descriptor(int open, const std::string& name) : path_(name), descriptor_(::dup(open)) {
  if (descriptor_ < 0) fail("open");
}

Descriptor::~Descriptor() { ::close(descriptor_); }

void Descriptor::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write");
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

std::size_t Descriptor::read(char* buffer, std::size_t size) {
  for (;;) {
    const ssize_t count = ::read(descriptor_, buffer, size);
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EINTR) fail("read");
  }
}

void Descriptor::truncate(std::int64_t size) {
  if (::ftruncate(descriptor_, size) != 0) fail("shorten");
}

void Descriptor::sync() {
  // Pipes and some network file systems cannot sync; that is no reason to lose a result.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP) fail("flush");
}

void Descriptor::fail(const char* action) const {
  throw FileError(path_, std::string("cannot ") + action + ": " + std::generic_category().message(errno));
}

}  // namespace taut
