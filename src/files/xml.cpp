#include "files/xml.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace taut {
namespace {

constexpr std::array<std::pair<char, std::string_view>, 7> entities{
    {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\t', "&#9;"}, {'\n', "&#10;"}, {'\r', "&#13;"}}};

}  // namespace

std::string xml_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    const auto entity = std::find_if(entities.begin(), entities.end(), [c](const auto& e) { return e.first == c; });
    if (entity != entities.end()) {
      escaped += entity->second;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      throw std::invalid_argument("xml_escaped: text must not contain the control character " + std::to_string(int{c}));
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string xml_unescaped(std::string_view text) {
  std::string plain;
  while (!text.empty()) {
    const auto entity =
        std::find_if(entities.begin(), entities.end(), [text](const auto& e) { return text.starts_with(e.second); });
    plain += entity != entities.end() ? entity->first : text.front();
    text.remove_prefix(entity != entities.end() ? entity->second.size() : 1);
  }
  return plain;
}

}  // namespace taut
