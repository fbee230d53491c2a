#pragma once

#include <string>
#include <string_view>

namespace taut {

/// 64-bit FNV-1a of some bytes, 16 hex digits.
std::string fnv1a(std::string_view bytes);

}  // namespace taut
