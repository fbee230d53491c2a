#include "energies/inertia.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <type_traits>

namespace taut {

Inertia Inertia::lumped(std::string name, const std::vector<RestTriangle>& triangles, double surface_density,
                        Index vertices) {
  std::vector<double> mass(static_cast<std::size_t>(vertices), 0.0);
  for (const RestTriangle& triangle : triangles) {
    for (int vertex : triangle.vertices) mass.at(vertex) += surface_density * triangle.area / 3;
  }
  Inertia inertia(std::move(name), 1);
  for (int vertex = 0; vertex < static_cast<int>(vertices); ++vertex) {
    if (mass[vertex] == 0) continue;
    inertia.add_element(std::array{vertex}, {&mass[vertex], 1});
  }
  return inertia;
}

Inertia Inertia::consistent(std::string name, const std::vector<RestTriangle>& triangles, double surface_density) {
  Inertia inertia(std::move(name), 3);
  for (const RestTriangle& triangle : triangles) {
    std::array<double, 9> mass;
    for (int i = 0; i < 9; ++i) mass[i] = surface_density * triangle.area * ((i % 4 == 0 ? 2.0 : 1.0) / 12.0);
    inertia.add_element(triangle.vertices, mass);
  }
  return inertia;
}

void Inertia::add_element(std::span<const int> nodes, std::span<const double> mass) {
  if (static_cast<int>(mass.size()) != nodes_ * nodes_) {
    throw std::invalid_argument("Inertia::add_element: expected " + std::to_string(nodes_ * nodes_) +
                                " entries of the mass matrix, got " + std::to_string(mass.size()));
  }
  axes_ == 3 ? stencils_.add_vertices(nodes) : stencils_.add(nodes);
  mass_.insert(mass_.end(), mass.begin(), mass.end());
}

void Inertia::set_target(double coefficient, const Vector& target) {
  coefficient_ = coefficient;
  target_ = target;
}

void Inertia::add_product(const Vector& v, Vector& out) const {
  for (Index element = 0; element < stencils_.count(); ++element) {
    const int* variables = stencils_[element];
    for (int i = 0; i < nodes_; ++i) {
      for (int j = 0; j < nodes_; ++j) {
        for (int axis = 0; axis < axes_; ++axis)
          out[variables[axes_ * i + axis]] += mass(element, i, j) * v[variables[axes_ * j + axis]];
      }
    }
  }
}

double Inertia::kinetic_energy(const Vector& velocity) const {
  Vector momentum = Vector::Zero(velocity.size());
  add_product(velocity, momentum);
  return 0.5 * velocity.dot(momentum);
}

/// Of one element, or of a quad of them.
template <class Real>
Real Inertia::evaluate_block(Index block, const Real* x, Real* gradient, Real* hessian) const {
  const int width = axes_ * nodes_;
  const auto block_mass = [&](int i, int j) -> Real {
    if constexpr (std::is_same_v<Real, double>) {
      return mass(block, i, j);
    } else {
      return lanes_of([&](int lane) { return mass(element_of(block, lane, stencils_.count()), i, j); });
    }
  };
  std::array<Real, max_stencil_width> offset, force;
  stencils_.gather(block, target_, offset.data());
  for (int i = 0; i < width; ++i) offset[i] = x[i] - offset[i];
  Real value = 0;
  for (int i = 0; i < nodes_; ++i) {
    for (int axis = 0; axis < axes_; ++axis) {
      Real sum = 0;
      for (int j = 0; j < nodes_; ++j) sum += block_mass(i, j) * offset[axes_ * j + axis];
      force[axes_ * i + axis] = coefficient_ * sum;
      value += 0.5 * force[axes_ * i + axis] * offset[axes_ * i + axis];
    }
  }
  if (gradient) std::copy_n(force.begin(), width, gradient);
  if (hessian) {
    std::fill_n(hessian, width * width, Real(0.0));
    for (int i = 0; i < nodes_; ++i) {
      for (int j = 0; j < nodes_; ++j) {
        const Real entry = coefficient_ * block_mass(i, j);
        for (int axis = 0; axis < axes_; ++axis) hessian[axes_ * i + axis + (axes_ * j + axis) * width] = entry;
      }
    }
  }
  return value;
}

double Inertia::evaluate(Index element, const double* x, double* gradient, double* hessian,
                         Curvature /*curvature*/) const {
  return evaluate_block(element, x, gradient, hessian);
}

Pack Inertia::evaluate_four(Index quad, const Pack* x, Pack* gradient, Pack* hessian, Curvature /*curvature*/) const {
  return evaluate_block(quad, x, gradient, hessian);
}

}  // namespace taut
