#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "problems/scene.h"

namespace taut {

/// The Scene of a document that complete() has passed (all but Scene::document and Scene::hash). Checks what a schema
/// cannot say: that bodies and files exist, min <= max, directions are not zero, keyframes ascend. Mesh files are
/// relative to `folder`; `source` is what errors call the file.
Scene scene_from_json(const nlohmann::json& document, const std::filesystem::path& folder, const std::string& source,
                      const std::string& default_name);

}  // namespace taut
