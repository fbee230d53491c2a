#pragma once

#include <memory>

#include "dynamics/modal/modal_basis.h"
#include "support/random_values.h"

namespace taut {

/// A basis that belongs to no body: four nodes, as many random shapes and rotations as asked for, values 1, 4, 9, ...
inline std::shared_ptr<ModalBasis> random_basis(int modes, unsigned seed = 1) {
  RandomValues random(seed);
  auto basis = std::make_shared<ModalBasis>();
  basis->rest = random.vector(12);
  basis->shapes = random.vector(12 * modes).reshaped(12, modes);
  basis->rotations = random.vector(12 * modes).reshaped(12, modes);
  basis->eigenvalues = Vector::LinSpaced(modes, 1, modes).cwiseAbs2();
  basis->residuals = Vector::Zero(modes);
  return basis;
}

}  // namespace taut
