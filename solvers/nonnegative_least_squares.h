#pragma once

#include <vector>

#include "core/types.h"

namespace taut {

/// The x that minimises |a x - b| with x_i >= 0 except where `free[i]` [Lawson and Hanson 1974, chapter 23], for a few
/// hundred columns. Where columns depend on each other, one of several minimisers.
Vector nonnegative_least_squares(const Matrix& a, const Vector& b, const std::vector<char>& free);

}  // namespace taut
