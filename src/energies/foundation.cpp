#include "energies/foundation.h"

#include <algorithm>
#include <stdexcept>

namespace taut {

WinklerFoundation::WinklerFoundation(std::string name, const std::vector<Spring>& springs, double stiffness)
    : name_(std::move(name)),
      nodes_(springs.empty() ? 1 : 1 + static_cast<int>(springs.front().carriers.size())),
      stencils_(3 * nodes_) {
  if (3 * nodes_ > max_stencil_width)
    throw std::invalid_argument("WinklerFoundation: " + std::to_string(nodes_ - 1) + " carriers, expected at most 7");
  for (const Spring& spring : springs) {
    std::vector<int> nodes{spring.node};
    nodes.insert(nodes.end(), spring.carriers.begin(), spring.carriers.end());
    stencils_.add_vertices(nodes);
    weights_.push_back(1);
    for (const double weight : spring.weights) weights_.push_back(-weight);
    stiffness_.push_back(stiffness * spring.area);
  }
}

double WinklerFoundation::evaluate(Index element, const double* x, double* gradient, double* hessian,
                                   Curvature /*curvature*/) const {
  const double* w = weights_.data() + element * nodes_;
  const double k = stiffness_[static_cast<std::size_t>(element)];
  double value = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double stretch = 0;
    for (int i = 0; i < nodes_; ++i) stretch += w[i] * x[3 * i + axis];
    value += 0.5 * k * stretch * stretch;
    for (int i = 0; gradient && i < nodes_; ++i) gradient[3 * i + axis] = k * stretch * w[i];
  }
  if (!hessian) return value;
  const int width = 3 * nodes_;
  std::fill_n(hessian, width * width, 0.0);
  for (int i = 0; i < nodes_; ++i) {
    for (int j = 0; j < nodes_; ++j) {
      for (int axis = 0; axis < 3; ++axis) hessian[3 * i + axis + (3 * j + axis) * width] = k * w[i] * w[j];
    }
  }
  return value;
}

}  // namespace taut
