#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace taut {

/// The bytes as a zlib stream (RFC 1950) in base64 (RFC 4648, with padding): how arrays travel inside JSON and HTML.
std::string packed_text(std::span<const std::byte> bytes);

}  // namespace taut
