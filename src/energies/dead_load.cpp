#include "energies/dead_load.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace taut {

DeadLoad::DeadLoad(std::string name, Vector forces, bool keep_all)
    : name_(std::move(name)), forces_(std::move(forces)) {
  for (int vertex = 0; vertex < static_cast<int>(forces_.size() / 3); ++vertex) {
    if (keep_all || !forces_.segment<3>(3 * vertex).isZero(0)) stencils_.add_vertices(std::array{vertex});
  }
}

void DeadLoad::set_forces(const Vector& forces) {
  if (forces.size() != forces_.size()) {
    throw std::invalid_argument("DeadLoad::set_forces: expected " + std::to_string(forces_.size()) + " entries, got " +
                                std::to_string(forces.size()));
  }
  forces_ = forces;
}

double DeadLoad::evaluate(Index element, const double* x, double* gradient, double* hessian,
                          Curvature /*curvature*/) const {
  const double* force = forces_.data() + stencils_[element][0];
  if (gradient) {
    for (int i = 0; i < 3; ++i) gradient[i] = -factor_ * force[i];
  }
  if (hessian) std::fill_n(hessian, 9, 0.0);
  return -factor_ * (force[0] * x[0] + force[1] * x[1] + force[2] * x[2]);
}

}  // namespace taut
