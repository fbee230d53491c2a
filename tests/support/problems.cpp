#include "support/problems.h"

#include "support/meshes.h"

namespace taut {

void OwnedProblem::pin(const std::vector<int>& vertices) {
  problem.fixed_values.resize(3 * static_cast<Index>(vertices.size()));
  for (int vertex : vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      problem.fixed_values[static_cast<Index>(problem.fixed_variables.size())] =
          problem.initial_guess[3 * vertex + axis];
      problem.fixed_variables.push_back(3 * vertex + axis);
    }
  }
}

Strip::Strip(double strip_width, double strip_length, int strip_rows)
    : mesh(make_grid(strip_width, strip_length, 1, strip_rows, Diagonals::left)),
      triangles(rest_triangles(mesh.triangles, mesh.vertices)),
      width(strip_width),
      length(strip_length),
      rows(strip_rows) {}

Vector Strip::row_values(double value) const {
  Vector values(2 * (rows + 1));
  for (int row = 0; row <= rows; ++row)
    values.segment<2>(2 * row).setConstant(0.5 * value * (row == 0 || row == rows ? 0.5 : 1.0));
  return values;
}

std::shared_ptr<Inertia> Strip::inertia(double row_mass) const {
  // A triangle whose corners are one vertex puts all of its mass there.
  std::vector<RestTriangle> points;
  const Vector mass = row_values(row_mass);
  points.reserve(static_cast<std::size_t>(mass.size()));
  for (int vertex = 0; vertex < static_cast<int>(mass.size()); ++vertex) {
    points.push_back({{vertex, vertex, vertex}, TriangleShape::Zero(), mass[vertex]});
  }
  return std::make_shared<Inertia>(Inertia::lumped("inertia", points, 1.0, mass.size()));
}

Vector Strip::row_forces(const Vector3& force) const {
  const Vector share = row_values(1.0);
  Vector forces(3 * share.size());
  for (Index vertex = 0; vertex < share.size(); ++vertex) forces.segment<3>(3 * vertex) = share[vertex] * force;
  return forces;
}

}  // namespace taut
