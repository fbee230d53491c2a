#pragma once

#include "problems/json_reader.h"

namespace taut {

/// Reads what only thick shells have.
class ShellReader : public JsonReader {
 public:
  using JsonReader::JsonReader;

  /// The shell of a body whose model is "thick_shell". Throws InputError for keys of cloth, for a thickness, density or
  /// material that is missing or said twice, and for materials that are not elastic.
  scene::ThickShell shell(const Json& body, const std::string& pointer) const;
  /// Throws InputError for keys of thick shells and for a thickness or density that is missing.
  void check_cloth(const Json& body, const std::string& pointer) const;
  /// Throws InputError for keys of sheets and for a density or material that is missing or not isotropic.
  void check_solid(const Json& body, const std::string& pointer) const;
  /// The surface that a constraint, load or probe names; `otherwise` where it names none. Throws InputError where the
  /// body is not a thick shell, and, unless `inside_prisms`, for the middle of an odd number of prisms.
  scene::Surface surface(const Json& json, const scene::Body& body, const std::string& pointer,
                         scene::Surface otherwise, bool inside_prisms = false) const;

 private:
  std::vector<scene::Layer> layers(const Json& body, const std::string& pointer) const;
  scene::Layer layer(const Json& json, const std::string& pointer) const;
  PrismShellOptions options(const Json& json, const std::string& pointer, int prisms) const;
  void refuse_keys(const Json& body, const std::string& pointer, std::initializer_list<const char*> keys,
                   const std::string& allowed) const;
};

}  // namespace taut
