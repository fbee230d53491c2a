#include "problems/json_reader.h"

#include <nlohmann/json.hpp>
#include <numbers>

namespace taut {

void JsonReader::refuse(const std::string& pointer, const std::string& found, const std::string& allowed) const {
  throw InputError(source_, pointer, "found " + found + ", allowed: " + allowed);
}

void JsonReader::missing(const std::string& pointer, const std::string& allowed) const {
  throw InputError(source_, pointer, "missing, allowed: " + allowed);
}

const std::string& JsonReader::word(const Json& text) { return text.get_ref<const std::string&>(); }

Vector3 JsonReader::vector(const Json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

double JsonReader::radians(const Json& degrees) { return degrees.get<double>() * std::numbers::pi / 180; }

std::optional<double> JsonReader::optional_number(const Json& json, const char* key) {
  return json.contains(key) ? std::optional<double>(json[key].get<double>()) : std::nullopt;
}

Vector3 JsonReader::direction(const Json& json, const std::string& pointer) const {
  const Vector3 d = vector(json);
  const double largest = d.cwiseAbs().maxCoeff();
  if (largest == 0) refuse(pointer, "[0, 0, 0]", "a vector that is not zero");
  return (d / largest).normalized();  // the squares of 1e-200 would vanish, those of 1e200 overflow
}

std::filesystem::path JsonReader::mesh_path(const Json& json, const std::string& pointer) const {
  std::filesystem::path path = folder_ / json.get<std::string>();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    refuse(pointer, json.dump(-1, ' ', false, Json::error_handler_t::replace),
           "an existing file (looked for " + path.string() + ")");
  return path;
}

}  // namespace taut
