#pragma once

#include <string>
#include <string_view>

namespace taut {

/// `text` as it may stand in an XML attribute or element. Throws std::invalid_argument for control characters that
/// XML 1.0 cannot hold.
std::string xml_escaped(std::string_view text);

/// Undoes xml_escaped(); what is not one of its entities stays as it is.
std::string xml_unescaped(std::string_view text);

}  // namespace taut
