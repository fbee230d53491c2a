#pragma once

#include <array>
#include <memory>

#include "core/types.h"

namespace taut {

/// Uninitialised numbers for the values and derivatives of one element, or of four: on the stack up to `Usual`, on the
/// heap beyond.
template <int Usual, class Real = double>
class Scratch {
 public:
  explicit Scratch(Index size) : heap_(size > Usual ? new Real[static_cast<std::size_t>(size)] : nullptr) {}
  Real* data() { return heap_ ? heap_.get() : stack_.data(); }
  Real& operator[](Index i) { return data()[i]; }

 private:
  std::array<Real, Usual> stack_;
  std::unique_ptr<Real[]> heap_;
};

}  // namespace taut
