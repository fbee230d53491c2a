#pragma once

#include "core/types.h"

namespace taut {

/// A sparse basis of the null space of `rows` (m x n): with the columns split by a column-pivoted QR into r basic ones
/// and the others, rows P = Q [R1 R2; 0 0], it is Z = P [-R1^{-1} R2; I], n x (n - r); entries below 1e-14 are dropped.
/// Dependent rows are allowed. [Nocedal and Wright 2006, (15.18)]
SparseMatrix null_space_basis(const SparseMatrix& rows);

}  // namespace taut
