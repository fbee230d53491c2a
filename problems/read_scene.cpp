#include "problems/read_scene.h"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "problems/hash.h"
#include "problems/scene_from_json.h"
#include "problems/schema.h"
#include "problems/solver_from_json.h"

namespace taut {

std::string fnv1a(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3u;
  return fmt::format("{:016x}", hash);
}

namespace {

using Document = nlohmann::ordered_json;  // as written: errors come in the order of the file
using Sorted = nlohmann::json;            // the Scene and its hash do not depend on that order

std::string file_bytes(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Calls change(file name) for every mesh file of the document and puts its answer in the name's place.
template <class Change>
void replace_mesh_files(Sorted& document, const Change& change) {
  for (Sorted& body : document["bodies"])
    for (const char* part : {"mesh", "rest", "top"})
      if (body.contains(part) && body[part].contains("file"))
        body[part]["file"] = change(body[part]["file"].get<std::string>());
  for (Sorted& body : document["bodies"])
    if (body.contains("modal") && body["modal"].contains("basis"))
      body["modal"]["basis"] = change(body["modal"]["basis"].get<std::string>());
}

std::string hash_of(Sorted document) {
  for (const char* key : {"output", "name", "description", "look_for", "$schema"}) document.erase(key);
  if (document["time"]["integrator"] == "static") document["time"].erase("step");
  replace_mesh_files(document, [](const std::string& name) { return fnv1a(file_bytes(name)); });
  return fnv1a(document.dump(-1, ' ', false, Sorted::error_handler_t::replace));
}

Document value_of(const std::string& text) {
  try {
    return parse_strict(text, "");
  } catch (const InputError&) {
    return text;  // not JSON: a plain word
  }
}

std::string keys_of(const Document& object) {
  std::string text;
  for (const auto& [key, value] : object.items()) text += (text.empty() ? "" : ", ") + key;
  return text;
}

/// Sets one dotted key, or with null takes it out. Its parent has to be there; whether the key itself may be is for the
/// schema to say.
void apply(Document& document, const std::string& key, const std::string& value, const std::string& source) {
  Document* parent = &document;
  std::string pointer;
  std::size_t begin = 0;
  for (std::size_t dot = key.find('.'); dot != std::string::npos; dot = key.find('.', begin)) {
    const std::string part = key.substr(begin, dot - begin);
    pointer += "/" + part;
    if (!parent->is_object() || !parent->contains(part))
      throw InputError(
          source, pointer,
          "not there, so nothing can be set in it; allowed: " +
              (parent->is_object() ? keys_of(*parent)
                                   : "nothing, as " + pointer.substr(0, pointer.rfind('/')) + " is no object"));
    parent = &(*parent)[part];
    begin = dot + 1;
  }
  if (!parent->is_object())
    throw InputError(source, pointer,
                     "found no object, so \"" + key.substr(begin) + "\" cannot be set in it; set \"" +
                         key.substr(0, begin - 1) + "\" as a whole");
  const Document set = value_of(value);
  if (set.is_null())
    parent->erase(key.substr(begin));
  else
    (*parent)[key.substr(begin)] = set;
}

std::string with_overrides(std::string source, const Overrides& overrides) {
  for (const auto& [key, value] : overrides) source += " --set " + key + "=" + value;
  return source;
}

void check_readable(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) throw InputError(file.string() + ": no such file");
  if (!std::ifstream(file)) throw InputError(file.string() + ": cannot be read");
}

}  // namespace

Scene read_scene(const std::filesystem::path& file, const Overrides& overrides) {
  std::string source = file.string();
  check_readable(file);
  if (file.extension() == ".nl") throw InputError(source + ": is an optimisation model, which taut solve alone takes");
  const Document schema = Document::parse(problem_schema());

  Document document = parse_strict(file_bytes(file), source);
  complete(document, schema, source);
  if (!overrides.empty()) {
    source = with_overrides(source, overrides);
    for (const auto& [key, value] : overrides) apply(document, key, value, source);
    complete(document, schema, source);
  }
  Sorted sorted = document;
  const std::filesystem::path folder = file.parent_path();
  Scene scene = scene_from_json(sorted, folder, source, file.stem().string());
  replace_mesh_files(sorted,
                     [&folder](const std::string& name) { return std::filesystem::absolute(folder / name).string(); });
  scene.document = sorted.dump(2, ' ', false, Sorted::error_handler_t::replace);
  scene.hash = hash_of(std::move(sorted));
  return scene;
}

Scene read_model_settings(const std::filesystem::path& model, const Overrides& overrides) {
  check_readable(model);
  const std::string source = with_overrides(model.string(), overrides);
  const Document whole = Document::parse(problem_schema());
  const Document schema = {{"type", "object"},
                           {"additionalProperties", false},
                           {"properties", {{"solver", whole["properties"]["solver"]}}},
                           {"definitions", whole["definitions"]}};
  Document document = {{"solver", {{"longest_step", 10}, {"newton_finish", true}, {"starts", 8}}}};
  complete(document, schema, source);
  for (const auto& [key, value] : overrides) apply(document, key, value, source);
  complete(document, schema, source);
  Scene scene;
  scene.name = model.stem().string();
  scene.source = source;
  scene.time.steps = 1;
  scene.solver = solver_from_json(Sorted(document["solver"]));
  scene.document = document.dump(2, ' ', false, Document::error_handler_t::replace);
  scene.hash = fnv1a(fnv1a(file_bytes(model)) + Sorted(document).dump());
  return scene;
}

}  // namespace taut
