#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "problems/scene.h"

namespace taut {

/// What the readers of a completed document share.
class JsonReader {
 public:
  using Json = nlohmann::json;

  /// Files are relative to `folder`; `source` is what errors call the document.
  JsonReader(std::filesystem::path folder, std::string source)
      : folder_(std::move(folder)), source_(std::move(source)) {}

 protected:
  [[noreturn]] void refuse(const std::string& pointer, const std::string& found, const std::string& allowed) const;
  [[noreturn]] void missing(const std::string& pointer, const std::string& allowed) const;

  static const std::string& word(const Json& text);
  /// The schema has admitted the text, so that one of the options matches.
  template <class Enum>
  static Enum choose(const Json& text, std::initializer_list<std::pair<std::string_view, Enum>> options) {
    for (const auto& [name, value] : options)
      if (word(text) == name) return value;
    throw std::logic_error("problem.schema.json allows \"" + word(text) + "\", read_scene does not");
  }

  static Vector3 vector(const Json& json);
  static double radians(const Json& degrees);
  static std::optional<double> optional_number(const Json& json, const char* key);
  /// Of length 1.
  Vector3 direction(const Json& json, const std::string& pointer) const;
  std::filesystem::path mesh_path(const Json& json, const std::string& pointer) const;

  std::filesystem::path folder_;
  std::string source_;
};

}  // namespace taut
