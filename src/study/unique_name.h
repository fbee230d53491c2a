#pragma once

#include <set>
#include <string>

#include "study/frame_output.h"

namespace taut {

/// `name` as a file's name (file_name()) that is not yet among `taken`, and then is.
inline std::string unique_name(const std::string& name, std::set<std::string>& taken) {
  const std::string wanted = file_name(name);
  std::string unique = wanted;
  for (int k = 2; !taken.insert(unique).second; ++k) unique = wanted + "_" + std::to_string(k);
  return unique;
}

}  // namespace taut
