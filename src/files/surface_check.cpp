#include "files/surface_check.h"

#include <fmt/format.h>

#include <stdexcept>

namespace taut {

void check_surface(std::string_view caller, const Vector& positions, const std::vector<Triangle>& triangles) {
  if (positions.size() % 3 != 0) {
    throw std::invalid_argument(
        fmt::format("{}: positions must hold 3 coordinates a vertex, got {} numbers", caller, positions.size()));
  }
  const Index vertices = positions.size() / 3;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const int vertex : triangles[t]) {
      if (vertex >= 0 && vertex < vertices) continue;
      throw std::invalid_argument(fmt::format("{}: triangles[{}] names vertex {}, expected one of the {} vertices",
                                              caller, t, vertex, vertices));
    }
  }
}

}  // namespace taut
