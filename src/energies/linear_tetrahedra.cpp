#include "energies/linear_tetrahedra.h"

#include <algorithm>
#include <array>

namespace taut {
namespace {

/// Edges from the first corner, one per column.
Matrix3 edges_of(const TetrahedronMesh& mesh, const Tetrahedron& cell) {
  Matrix3 edges;
  for (int j = 0; j < 3; ++j) edges.col(j) = mesh.vertices[cell[j + 1]] - mesh.vertices[cell[0]];
  return edges;
}

}  // namespace

LinearTetrahedra::LinearTetrahedra(std::string name, const TetrahedronMesh& mesh, double young_modulus,
                                   double poisson_ratio)
    : name_(std::move(name)) {
  const double mu = young_modulus / (2 * (1 + poisson_ratio));
  const double lambda = young_modulus * poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  for (const Tetrahedron& cell : mesh.cells) {
    stencils_.add_vertices(cell);
    const Matrix3 edges = edges_of(mesh, cell), inverse = edges.inverse();
    const double volume = edges.determinant() / 6;
    std::array<Vector3, 4> g;
    g[0] = -inverse.colwise().sum();
    for (int j = 0; j < 3; ++j) g[j + 1] = inverse.row(j);
    Local& rest = rest_.emplace_back();
    Stiffness& stiffness = stiffness_.emplace_back();
    for (int i = 0; i < 4; ++i) {
      rest.segment<3>(3 * i) = mesh.vertices[cell[i]];
      for (int j = 0; j < 4; ++j) {
        stiffness.block<3, 3>(3 * i, 3 * j) =
            volume * (lambda * g[i] * g[j].transpose() + mu * g[j] * g[i].transpose() +
                      mu * g[i].dot(g[j]) * Matrix3::Identity());
      }
    }
  }
}

double LinearTetrahedra::evaluate(Index element, const double* x, double* gradient, double* hessian,
                                  Curvature /*curvature*/) const {
  const auto k = static_cast<std::size_t>(element);
  const Local moved = Eigen::Map<const Local>(x) - rest_[k], force = stiffness_[k] * moved;
  if (gradient) std::copy_n(force.data(), 12, gradient);
  if (hessian) std::copy_n(stiffness_[k].data(), 144, hessian);
  return 0.5 * moved.dot(force);
}

Inertia tetrahedron_inertia(std::string name, const TetrahedronMesh& mesh, double density, bool lumped) {
  Inertia inertia(std::move(name), lumped ? 1 : 4);
  std::vector<double> masses(mesh.vertices.size(), 0.0);
  for (const Tetrahedron& cell : mesh.cells) {
    const double mass = density * edges_of(mesh, cell).determinant() / 6;
    for (const int corner : cell) masses[corner] += mass / 4;
    std::array<double, 16> consistent;
    for (int i = 0; i < 16; ++i) consistent[i] = mass / 20 * (i % 5 == 0 ? 2 : 1);
    if (!lumped) inertia.add_element(cell, consistent);
  }
  if (!lumped) return inertia;
  for (int node = 0; node < static_cast<int>(masses.size()); ++node)
    inertia.add_element(std::array{node}, {&masses[node], 1});
  return inertia;
}

}  // namespace taut
