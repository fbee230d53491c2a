#pragma once

#include <array>
#include <memory>

#include "core/types.h"

namespace taut {

/// Uninitialised doubles for the values and derivatives of one element: on the stack up to `Usual`, on the heap beyond.
template <int Usual>
class Scratch {
 public:
  explicit Scratch(Index size) : heap_(size > Usual ? new double[static_cast<std::size_t>(size)] : nullptr) {}
  double* data() { return heap_ ? heap_.get() : stack_.data(); }
  double& operator[](Index i) { return data()[i]; }

 private:
  std::array<double, Usual> stack_;
  std::unique_ptr<double[]> heap_;
};

}  // namespace taut
