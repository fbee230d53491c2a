#include "energies/prism_mass.h"

#include <algorithm>
#include <stdexcept>

namespace taut {
namespace {

/// 120 times the integral of L_i L_j L_k over the unit triangle.
double triple(int i, int j, int k) {
  if (i == j && j == k) return 6;
  return i == j || j == k || i == k ? 2 : 1;
}

PrismMass checked_mass(const Prism& prism, const std::vector<Vector3>& nodes, double density) {
  std::array<Vector3, 6> points;
  for (int j = 0; j < 6; ++j) points[j] = nodes.at(prism[j]);
  const PrismShape shape(points);
  if (!(PrismJacobian(shape).smallest() > 0)) {
    throw std::invalid_argument(
        "prism inertia: expected prisms with a positive Jacobian, got an inverted one at node " +
        std::to_string(prism[0]));
  }
  return surface_mass(shape, density);
}

}  // namespace

PrismMass director_mass(const PrismShape& shape, double density) {
  const PrismJacobian jacobian(shape);
  PrismMass mass;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      double sum = 0, weighted_g = 0, weighted_h = 0;
      for (int k = 0; k < 3; ++k) {
        const double t = triple(i, j, k) / 120;
        sum += t;
        weighted_g += t * jacobian.g[k];
        weighted_h += t * jacobian.h[k];
      }
      mass(i, j) = density * (2 * weighted_g + 2.0 / 3 * sum * jacobian.i);
      mass(i, j + 3) = mass(i + 3, j) = density * 2.0 / 3 * weighted_h;
      mass(i + 3, j + 3) = density * (2.0 / 3 * weighted_g + 2.0 / 5 * sum * jacobian.i);
    }
  }
  return mass;
}

PrismMass surface_mass(const PrismShape& shape, double density) {
  PrismMass to_directors = PrismMass::Zero();  // MLTS (23)
  for (int j = 0; j < 3; ++j) {
    to_directors(j, 2 * j) = to_directors(j, 2 * j + 1) = to_directors(j + 3, 2 * j + 1) = 0.5;
    to_directors(j + 3, 2 * j) = -0.5;
  }
  return to_directors.transpose() * director_mass(shape, density) * to_directors;
}

Inertia consistent_prism_inertia(std::string name, const std::vector<Prism>& prisms, const std::vector<Vector3>& nodes,
                                 double density, int first_node) {
  Inertia inertia(std::move(name), 6);
  for (Prism prism : prisms) {
    const PrismMass mass = checked_mass(prism, nodes, density);
    for (int& node : prism) node += first_node;
    inertia.add_element(prism, {mass.data(), 36});
  }
  return inertia;
}

Inertia lumped_prism_inertia(std::string name, const std::vector<Prism>& prisms, const std::vector<Vector3>& nodes,
                             double density, int first_node) {
  std::vector<double> lumped(nodes.size(), 0.0);
  for (const Prism& prism : prisms) {
    const PrismMass mass = checked_mass(prism, nodes, density);
    for (int j = 0; j < 6; ++j) lumped[prism[j]] += mass.row(j).sum();
  }
  Inertia inertia(std::move(name), 1);
  for (std::size_t node = 0; node < nodes.size(); ++node) {
    if (lumped[node] > 0) inertia.add_element(std::array{static_cast<int>(node) + first_node}, {&lumped[node], 1});
  }
  return inertia;
}

}  // namespace taut
