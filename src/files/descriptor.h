#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace taut {

/// An open POSIX file. The streams of the C++ library can neither fsync nor truncate, and both are what keeps results
/// safe. Every failure throws FileError with the system's reason.
class Descriptor {
 public:
  /// `flags` as for open(2); files are created with the permissions that the umask leaves.
  Descriptor(const std::filesystem::path& path, int flags);
  /// A copy of one that is open, such as a standard stream; `name` is for messages.
  Descriptor(int open, const std::string& name);
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void write(std::string_view bytes);
  /// Fills at most `size` bytes; returns how many, 0 at the end of the file.
  std::size_t read(char* buffer, std::size_t size);
  void truncate(std::int64_t size);
  /// Returns once the device has the data.
  void sync();

 private:
  [[noreturn]] void fail(const char* action) const;

  std::filesystem::path path_;
  int descriptor_;
};

}  // namespace taut
