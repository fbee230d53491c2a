#include "core/stencils.h"

#include <stdexcept>
#include <string>

namespace taut {

void Stencils::add(std::span<const int> variables) {
  if (static_cast<int>(variables.size()) != width_) {
    throw std::invalid_argument("Stencils::add: expected " + std::to_string(width_) + " variables, got " +
                                std::to_string(variables.size()));
  }
  variables_.insert(variables_.end(), variables.begin(), variables.end());
  ++count_;
}

void Stencils::add_vertices(std::span<const int> vertices) {
  if (static_cast<int>(vertices.size()) * 3 != width_) {
    throw std::invalid_argument("Stencils::add_vertices: expected " + std::to_string(width_ / 3) + " vertices, got " +
                                std::to_string(vertices.size()));
  }
  for (int vertex : vertices) {
    for (int axis = 0; axis < 3; ++axis) variables_.push_back(3 * vertex + axis);
  }
  ++count_;
}

}  // namespace taut
