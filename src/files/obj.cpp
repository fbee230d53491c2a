#include "files/obj.h"

#include <fmt/format.h>

#include <iterator>
#include <string>

#include "files/atomic_file.h"
#include "files/surface_check.h"

namespace taut {

void write_obj(const std::filesystem::path& path, const Vector& positions, const std::vector<Triangle>& triangles) {
  check_surface("write_obj", positions, triangles);
  if (!positions.allFinite()) throw std::invalid_argument("write_obj: positions must be finite numbers");
  std::string text;
  const auto end = std::back_inserter(text);
  for (Index i = 0; i < positions.size(); i += 3) {
    fmt::format_to(end, "v {} {} {}\n", positions[i], positions[i + 1], positions[i + 2]);
  }
  for (const auto& [a, b, c] : triangles) fmt::format_to(end, "f {} {} {}\n", a + 1, b + 1, c + 1);
  write_atomically(path, text);
}

}  // namespace taut
