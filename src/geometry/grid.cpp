#include "geometry/grid.h"

#include <cmath>
#include <limits>
#include <stdexcept>

namespace taut {
namespace {

void require_size(double size, const char* name) {
  if (!(size > 0) || !std::isfinite(size)) {
    throw std::invalid_argument(std::string("make_grid: ") + name + " is " + std::to_string(size) +
                                ", expected a positive length");
  }
}

void require_cells(int cells, const char* name) {
  if (cells < 1) {
    throw std::invalid_argument(std::string("make_grid: ") + name + " is " + std::to_string(cells) +
                                ", expected at least 1");
  }
}

bool runs_right(Diagonals diagonals, int i, int j) {
  return diagonals == Diagonals::right || (diagonals == Diagonals::alternating && (i + j) % 2 == 0);
}

void add_cell(TriangleMesh& mesh, int i, int j, Diagonals diagonals) {
  const int stride = mesh.cells_x + 1;
  const int a = j * stride + i, b = a + 1, c = b + stride, d = a + stride;  // counter-clockwise from (i, j)
  if (diagonals == Diagonals::union_jack) {
    const int middle = stride * (mesh.cells_y + 1) + j * mesh.cells_x + i;
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, middle}, {b, c, middle}, {c, d, middle}, {d, a, middle}});
  } else if (runs_right(diagonals, i, j)) {
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
  } else {
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {b, c, d}});
  }
}

}  // namespace

TriangleMesh make_grid(double size_x, double size_y, int cells_x, int cells_y, Diagonals diagonals) {
  require_size(size_x, "size_x");
  require_size(size_y, "size_y");
  require_cells(cells_x, "cells_x");
  require_cells(cells_y, "cells_y");
  constexpr double most_cells = std::numeric_limits<int>::max() / 4.0;
  if ((cells_x + 1.0) * (cells_y + 1.0) > most_cells) {
    throw std::invalid_argument("make_grid: " + std::to_string(cells_x) + " x " + std::to_string(cells_y) +
                                " cells, expected few enough that triangles can be numbered by int");
  }

  TriangleMesh mesh;
  mesh.cells_x = cells_x;
  mesh.cells_y = cells_y;
  const auto position = [&](double i, double j) { return Vector3(size_x * i / cells_x, size_y * j / cells_y, 0); };
  for (int j = 0; j <= cells_y; ++j) {
    for (int i = 0; i <= cells_x; ++i) mesh.vertices.push_back(position(i, j));
  }
  if (diagonals == Diagonals::union_jack) {
    for (int j = 0; j < cells_y; ++j) {
      for (int i = 0; i < cells_x; ++i) mesh.vertices.push_back(position(i + 0.5, j + 0.5));
    }
  }
  for (int j = 0; j < cells_y; ++j) {
    for (int i = 0; i < cells_x; ++i) add_cell(mesh, i, j, diagonals);
  }
  for (const Triangle& triangle : mesh.triangles) {
    mesh.corner_uv.push_back({mesh.vertices[triangle[0]].head<2>(), mesh.vertices[triangle[1]].head<2>(),
                              mesh.vertices[triangle[2]].head<2>()});
  }
  return mesh;
}

}  // namespace taut
