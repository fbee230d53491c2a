#include "study/stress_atlas.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "problems/schema.h"
#include "study/solver_entries.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// Reads parts of the atlas and knows what errors have to call them.
class AtlasReader {
 public:
  explicit AtlasReader(const fs::path& file)
      : source_(file.string()), catalogue_(fs::absolute(file).parent_path().parent_path()) {}

  std::vector<StressEntry> read(const Json& atlas) const {
    allow_only(atlas, "", {"methods", "entries"});
    const auto methods = words(atlas, "", "methods");
    std::vector<StressEntry> entries;
    for (const auto& [name, json] : member(atlas, "", "entries").items()) entries.push_back(entry(name, json, methods));
    return entries;
  }

 private:
  [[noreturn]] void refuse(const std::string& pointer, const std::string& text) const {
    throw InputError(source_, pointer, text);
  }

  const Json& member(const Json& object, const std::string& pointer, const std::string& key) const {
    if (!object.is_object() || !object.contains(key)) refuse(pointer, "found no \"" + key + "\", which is required");
    return object[key];
  }

  void allow_only(const Json& object, const std::string& pointer, const std::vector<std::string>& keys) const {
    if (!object.is_object()) refuse(pointer, "found " + object.dump() + ", allowed: an object");
    std::string allowed;
    for (const std::string& key : keys) allowed += (allowed.empty() ? "" : ", ") + key;
    for (const auto& [key, value] : object.items()) {
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
        refuse(pointer + "/" + key, "found an unknown key, allowed: " + allowed);
    }
  }

  std::string word(const Json& object, const std::string& pointer, const std::string& key) const {
    const Json& json = member(object, pointer, key);
    if (!json.is_string()) refuse(pointer + "/" + key, "found " + json.dump() + ", allowed: a string");
    return json;
  }

  std::vector<std::string> words(const Json& object, const std::string& pointer, const std::string& key) const {
    const Json& json = member(object, pointer, key);
    const bool fits =
        json.is_array() && std::all_of(json.begin(), json.end(), [](const Json& one) { return one.is_string(); });
    if (!fits) refuse(pointer + "/" + key, "found " + json.dump() + ", allowed: a list of strings");
    return json.get<std::vector<std::string>>();
  }

  Overrides settings(const Json& object, const std::string& pointer) const {
    Overrides overrides;
    if (!object.contains("set")) return overrides;
    if (!object["set"].is_object()) refuse(pointer + "/set", "found " + object["set"].dump() + ", allowed: an object");
    for (const auto& [key, value] : object["set"].items())
      overrides.emplace_back(key, value.is_string() ? value.get<std::string>() : value.dump());
    return overrides;
  }

  StressValue value(const Json& entry, const Json& json, const std::string& pointer) const {
    StressValue value;
    if (json.is_string()) {
      value.label = json;
      value.overrides = {{word(entry, pointer.substr(0, pointer.rfind("/values")), "key"), value.label}};
      return value;
    }
    allow_only(json, pointer, {"label", "set"});
    value.label = word(json, pointer, "label");
    value.overrides = settings(json, pointer);
    return value;
  }

  StressEntry entry(const std::string& name, const Json& json, const std::vector<std::string>& methods) const {
    const std::string pointer = "/entries/" + name;
    allow_only(json, pointer, {"title", "problem", "knob", "key", "values", "set", "quick", "methods", "losses"});
    StressEntry entry;
    entry.name = name;
    entry.title = word(json, pointer, "title");
    entry.knob = word(json, pointer, "knob");
    entry.problem = word(json, pointer, "problem");
    entry.file = catalogue_ / (entry.problem + ".json");
    if (!fs::is_regular_file(entry.file)) refuse(pointer + "/problem", "found " + entry.problem + ", no such file");
    entry.overrides = settings(json, pointer);
    entry.methods = json.contains("methods") ? words(json, pointer, "methods") : methods;
    for (const std::string& method : entry.methods) solver_entry(method);
    const Json& values = member(json, pointer, "values");
    if (!values.is_array() || values.empty()) refuse(pointer + "/values", "found no values, allowed: a list of them");
    for (std::size_t k = 0; k < values.size(); ++k)
      entry.values.push_back(value(json, values[k], pointer + "/values/" + std::to_string(k)));
    const auto find = [&](const std::string& label, const std::string& key) -> StressValue& {
      const auto found = std::find_if(entry.values.begin(), entry.values.end(),
                                      [&](const StressValue& one) { return one.label == label; });
      if (found == entry.values.end()) refuse(pointer + "/" + key, "found " + label + ", allowed: one of the values");
      return *found;
    };
    if (json.contains("quick")) {
      for (const std::string& label : words(json, pointer, "quick")) find(label, "quick").quick = true;
    }
    if (json.contains("losses")) {
      allow_only(json["losses"], pointer + "/losses", labels(entry));
      for (const auto& [label, mechanism] : json["losses"].items())
        entry.losses[label] = word(json["losses"], pointer + "/losses", label);
    }
    return entry;
  }

  static std::vector<std::string> labels(const StressEntry& entry) {
    std::vector<std::string> all;
    for (const StressValue& value : entry.values) all.push_back(value.label);
    return all;
  }

  std::string source_;
  fs::path catalogue_;
};

}  // namespace

std::vector<StressEntry> read_stress_atlas(const fs::path& file) {
  return AtlasReader(file).read(parse_strict(read_bytes(file), file.string()));
}

}  // namespace taut
