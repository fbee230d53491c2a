#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <numbers>
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
  [[noreturn]] void refuse(const std::string& pointer, const std::string& found, const std::string& allowed) const {
    throw InputError(source_, pointer, "found " + found + ", allowed: " + allowed);
  }
  [[noreturn]] void missing(const std::string& pointer, const std::string& allowed) const {
    throw InputError(source_, pointer, "missing, allowed: " + allowed);
  }

  /// The schema has admitted the text, so that one of the options matches.
  template <class Enum>
  static Enum choose(const Json& text, std::initializer_list<std::pair<std::string_view, Enum>> options) {
    for (const auto& [name, value] : options)
      if (text.get_ref<const std::string&>() == name) return value;
    throw std::logic_error("problem.schema.json allows \"" + text.get<std::string>() + "\", read_scene does not");
  }

  static Vector3 vector(const Json& json) {
    return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
  }
  static double radians(const Json& degrees) { return degrees.get<double>() * std::numbers::pi / 180; }
  static std::optional<double> optional_number(const Json& json, const char* key) {
    return json.contains(key) ? std::optional<double>(json[key].get<double>()) : std::nullopt;
  }

  /// Of length 1.
  Vector3 direction(const Json& json, const std::string& pointer) const {
    const Vector3 d = vector(json);
    const double largest = d.cwiseAbs().maxCoeff();
    if (largest == 0) refuse(pointer, "[0, 0, 0]", "a vector that is not zero");
    return (d / largest).normalized();  // the squares of 1e-200 would vanish, those of 1e200 overflow
  }

  std::filesystem::path mesh_path(const Json& json, const std::string& pointer) const {
    const std::filesystem::path path = folder_ / json.get<std::string>();
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
      refuse(pointer, json.dump(-1, ' ', false, Json::error_handler_t::replace),
             "an existing file (looked for " + path.string() + ")");
    return path;
  }

  std::filesystem::path folder_;
  std::string source_;
};

}  // namespace taut
