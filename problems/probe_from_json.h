#pragma once

#include <vector>

#include "problems/shell_from_json.h"

namespace taut {

/// Reads what refers to bodies that are there already: selections and probes.
class ProbeReader : public ShellReader {
 public:
  using ShellReader::ShellReader;

 protected:
  /// Throws InputError for a name that no body has.
  int body_index(const Json& json, const std::string& pointer) const;
  /// Throws InputError for corners and edges of what is no grid, and for boxes inside out.
  scene::Selection selection(const Json& json, int body, const std::string& pointer) const;
  /// Throws InputError for keys that do not belong to the quantity, or are missing.
  scene::Probe probe(const std::string& name, const Json& json, const scene::Time& time) const;

  const std::vector<scene::Body>* bodies_ = nullptr;

 private:
  scene::InBox box(const Json& json, const std::string& pointer) const;
  /// A stress resultant, a stress or a stretch.
  void shell_probe(const std::string& quantity, const Json& json, const std::string& pointer,
                   scene::Probe& result) const;
  scene::Expected expected(const Json& json, const std::string& pointer) const;
};

}  // namespace taut
