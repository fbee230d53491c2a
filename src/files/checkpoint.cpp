#include "files/checkpoint.h"

#include <zlib.h>

#include <bit>
#include <cstring>
#include <string_view>

#include "files/atomic_file.h"

namespace taut {
namespace {

static_assert(std::endian::native == std::endian::little, "checkpoints are little-endian");

// The file: magic, version, CRC-32 of the content, length of the content, content.
constexpr std::string_view magic = "TAUTCKPT";
constexpr std::uint32_t version = 1;
constexpr std::size_t header_size = magic.size() + 2 * sizeof(std::uint32_t) + sizeof(std::uint64_t);

std::uint32_t checksum(std::string_view content) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()));
}

template <typename Number>
void put(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

void put_text(std::string& bytes, std::string_view text) {
  put<std::uint64_t>(bytes, text.size());
  bytes += text;
}

void put_array(std::string& bytes, const std::vector<double>& array) {
  put<std::uint64_t>(bytes, array.size());
  bytes.append(reinterpret_cast<const char*>(array.data()), array.size() * sizeof(double));
}

/// Takes values off the front of `bytes`, never past their end.
class Decoder {
 public:
  Decoder(std::string_view bytes, const std::filesystem::path& path) : bytes_(bytes), path_(path) {}

  template <typename Number>
  Number number() {
    Number value;
    std::memcpy(&value, take(1, sizeof value).data(), sizeof value);
    return value;
  }
  std::string text() { return std::string(take(number<std::uint64_t>(), 1)); }
  std::vector<double> array() {
    const std::string_view bytes = take(number<std::uint64_t>(), sizeof(double));
    std::vector<double> values(bytes.size() / sizeof(double));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }

 private:
  std::string_view take(std::uint64_t count, std::size_t size) {
    if (count > bytes_.size() / size)
      throw FileError(path_, "damaged checkpoint: a length inside it leads past its end");
    const std::string_view front = bytes_.substr(0, count * size);
    bytes_.remove_prefix(front.size());
    return front;
  }

  std::string_view bytes_;
  const std::filesystem::path& path_;
};

std::string encode(const Checkpoint& checkpoint) {
  std::string content;
  put_text(content, checkpoint.input_hash);
  put<std::int64_t>(content, checkpoint.step);
  put<std::uint64_t>(content, checkpoint.arrays.size());
  for (const auto& [name, array] : checkpoint.arrays) {
    put_text(content, name);
    put_array(content, array);
  }
  put<std::uint64_t>(content, checkpoint.texts.size());
  for (const auto& [name, text] : checkpoint.texts) {
    put_text(content, name);
    put_text(content, text);
  }
  return content;
}

Checkpoint decode(Decoder content) {
  Checkpoint checkpoint;
  checkpoint.input_hash = content.text();
  checkpoint.step = content.number<std::int64_t>();
  for (auto left = content.number<std::uint64_t>(); left > 0; --left) {
    std::string name = content.text();
    checkpoint.arrays[std::move(name)] = content.array();
  }
  for (auto left = content.number<std::uint64_t>(); left > 0; --left) {
    std::string name = content.text();
    checkpoint.texts[std::move(name)] = content.text();
  }
  return checkpoint;
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  const std::string content = encode(checkpoint);
  std::string bytes;
  bytes.reserve(header_size + content.size());
  bytes += magic;
  put(bytes, version);
  put(bytes, checksum(content));
  put<std::uint64_t>(bytes, content.size());
  write_atomically(path, bytes += content);
}

Checkpoint read_checkpoint(const std::filesystem::path& path) {
  const std::string bytes = read_bytes(path);
  const std::string_view view = bytes;
  if (!view.starts_with(magic)) throw FileError(path, "is not a taut checkpoint");
  if (view.size() < header_size) throw FileError(path, "damaged checkpoint: cut short inside its header");

  Decoder header(view.substr(magic.size()), path);
  const auto found_version = header.number<std::uint32_t>();
  const auto found_checksum = header.number<std::uint32_t>();
  const auto found_size = header.number<std::uint64_t>();
  if (found_version != version) {
    throw FileError(path, "checkpoint of format version " + std::to_string(found_version) +
                              ", this program reads version " + std::to_string(version));
  }
  const std::string_view content = view.substr(header_size);
  if (found_size != content.size()) {
    throw FileError(path, "damaged checkpoint: holds " + std::to_string(content.size()) +
                              " bytes of content where its header says " + std::to_string(found_size));
  }
  if (found_checksum != checksum(content))
    throw FileError(path, "damaged checkpoint: its content does not match its CRC-32");
  return decode(Decoder(content, path));
}

}  // namespace taut
