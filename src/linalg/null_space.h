#pragma once

#include "core/types.h"

namespace taut {

/// A sparse basis of the null space of `rows` (m x n): with the columns split by a column-pivoted QR into r basic ones
/// and the others, rows P = Q [R1 R2; 0 0], it is Z = P [-R1^{-1} R2; I], n x (n - r); entries below 1e-14 are dropped.
/// Dependent rows are allowed: after scaling rows to length 1, a pivot below 1e-10 of the largest counts as zero.
/// Rows without common columns, even through others, are factorised apart, each such set as a dense matrix.
/// [Nocedal and Wright 2006, (15.18)]
SparseMatrix null_space_basis(const SparseMatrix& rows);

}  // namespace taut
