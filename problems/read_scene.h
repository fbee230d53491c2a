#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "problems/scene.h"

namespace taut {

/// A dotted key and its new value: {"constraints.limit.max", "1.05"}. The value is JSON, or else a string.
using Overrides = std::vector<std::pair<std::string, std::string>>;

/// Reads a problem file. Throws InputError for anything that problem.schema.json or the Scene's cross references do not
/// allow, for files that are missing, and for overrides of keys that are not there. Sections that have a default can be
/// overridden.
///
/// Scene::hash is the 64-bit FNV-1a of the completed document without output, name, description, look_for and $schema,
/// with every mesh file's name replaced by the hash of its bytes. It does not depend on key order, comments, spelling
/// of numbers, or paths.
Scene read_scene(const std::filesystem::path& file, const Overrides& overrides = {});

/// What a model file (nl_model.h), which has no scene, is solved with: a Scene without bodies that has a name, a source
/// and `solver`, the only section that can be overridden. The hash is that of the file's bytes and the settings. Throws
/// InputError as above.
Scene read_model_settings(const std::filesystem::path& model, const Overrides& overrides = {});

}  // namespace taut
