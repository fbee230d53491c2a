#include "files/packed_text.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <vector>

namespace taut {
namespace {

std::vector<std::uint8_t> from_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(letters.find(c));
    count += 6;
    if (count >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
  }
  return bytes;
}

TEST(PackedText, UnpacksToTheSameBytesWhateverTheirNumber) {
  for (std::size_t size : {0u, 1u, 2u, 3u, 4u, 1000u}) {
    std::vector<std::uint8_t> bytes(size);
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i * i);
    const std::string text = packed_text(std::as_bytes(std::span(bytes)));
    EXPECT_EQ(text.size() % 4, 0u);
    const std::vector<std::uint8_t> stream = from_base64(text);
    std::vector<std::uint8_t> again(size + 1);
    uLongf length = again.size();
    ASSERT_EQ(::uncompress(again.data(), &length, stream.data(), stream.size()), Z_OK);
    again.resize(length);
    EXPECT_EQ(again, bytes);
  }
}

}  // namespace
}  // namespace taut
