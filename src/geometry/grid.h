#pragma once

#include "geometry/triangle_mesh.h"

namespace taut {

/// How the cells of a grid are cut into triangles, seen from +z with x to the right and y up.
enum class Diagonals {
  alternating,  ///< "/" in cell (i, j) where i + j is even and "\" elsewhere: vertices belong to 8 and 4 triangles in
                ///< turn, and (0, 0) to two
  left,         ///< "\" everywhere, from (i + 1, j) to (i, j + 1)
  right,        ///< "/" everywhere, from (i, j) to (i + 1, j + 1)
  union_jack,   ///< both diagonals, meeting in a vertex of their own in the middle of the cell: the flag around every
                ///< inner grid vertex
};

/// A flat rectangle at z = 0 with vertex (i, j) = j * (cells_x + 1) + i at (size_x i / cells_x, size_y j / cells_y),
/// counter-clockwise seen from +z.
///
/// With `union_jack` the middle of cell (i, j) is vertex (cells_x + 1)(cells_y + 1) + j cells_x + i; it is the tiling
/// of `alternating` turned by 45 degrees, and unlike that one it has all the symmetries of the rectangle for odd and
/// even numbers of cells. Triangles come cell by cell, i fastest. corner_uv holds x and y. Sizes in metres.
///
/// Throws std::invalid_argument where a size is not positive and finite, a number of cells is not positive, or the
/// product (cells_x + 1)(cells_y + 1) exceeds a quarter of 2^31.
TriangleMesh make_grid(double size_x, double size_y, int cells_x, int cells_y, Diagonals diagonals);

}  // namespace taut
