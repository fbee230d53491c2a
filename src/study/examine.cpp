#include "study/examine.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "constraints/obstacle.h"
#include "geometry/distance.h"

namespace taut {
namespace {

struct Outside {
  double relative, violation;
  const Constraint* constraint;   // or
  const LinearEqualities* equal;  // null: the other
  Index element;

  WorstElement named() const {
    if (equal) return {equal->name, equal->row_name(element), violation};
    return {constraint->name(), constraint->element_name(element), violation};
  }
};

/// Which vertices the constraint holds at.
std::vector<char> held_at(const SphereObstacle& sphere, std::size_t vertices) {
  std::vector<char> chosen(vertices, 0);
  for (Index element = 0; element < sphere.stencils().count(); ++element) {
    chosen[static_cast<std::size_t>(sphere.stencils()[element][0] / 3)] = 1;
  }
  return chosen;
}

Penetration penetration_of(const SphereObstacle& sphere, const std::vector<Triangle>& triangles, const Vector& x) {
  const std::vector<char> chosen = held_at(sphere, static_cast<std::size_t>(x.size() / 3));
  const Vector3& center = sphere.center();
  const auto depth = [&sphere](double distance) { return sphere.radius() - distance; };
  Penetration deepest{sphere.name(), 0, 0};
  for (const Triangle& triangle : triangles) {
    const std::array<Vector3, 3> p{x.segment<3>(3 * triangle[0]), x.segment<3>(3 * triangle[1]),
                                   x.segment<3>(3 * triangle[2])};
    for (int side = 0; side < 3; ++side) {
      const int next = (side + 1) % 3;
      if (!chosen[triangle[side]] || !chosen[triangle[next]]) continue;
      deepest.edge = std::max(deepest.edge, depth(point_segment_distance(center, p[side], p[next]).distance));
    }
    if (!chosen[triangle[0]] || !chosen[triangle[1]] || !chosen[triangle[2]]) continue;
    deepest.face = std::max(deepest.face, depth(point_triangle_distance(center, p[0], p[1], p[2]).distance));
  }
  return deepest;
}

}  // namespace

std::string pins_name(const Model& model) {
  for (const auto& constraint : model.constraints) {
    if (constraint->name() == "pins") return "pins (held vertices)";
  }
  return "pins";
}

double objective(const Problem& problem, const Vector& x) {
  double sum = 0;
  for (const Energy* energy : problem.energies) {
    const Stencils& stencils = energy->stencils();
    Vector local(stencils.width());
    for (Index element = 0; element < stencils.count(); ++element) {
      stencils.gather(element, x, local.data());
      sum += energy->evaluate(element, local.data(), nullptr, nullptr, Curvature::exact);
    }
  }
  return sum;
}

std::vector<Penetration> penetrations(const Model& model, const Vector& x) {
  std::vector<Penetration> all;
  for (const auto& constraint : model.constraints) {
    const auto* sphere = dynamic_cast<const SphereObstacle*>(constraint.get());
    if (sphere) all.push_back(penetration_of(*sphere, model.triangles, x));
  }
  return all;
}

std::vector<WorstElement> worst_elements(const Problem& problem, const Vector& x, int count) {
  std::vector<Outside> outside;
  for (const Constraint* constraint : problem.constraints) {
    const Stencils& stencils = constraint->stencils();
    Vector local(stencils.width());
    for (Index element = 0; element < stencils.count(); ++element) {
      stencils.gather(element, x, local.data());
      const double violation = constraint->violation(element, local.data());
      if (violation > 0)
        outside.push_back({violation / constraint->violation_scale(), violation, constraint, nullptr, element});
    }
  }
  for (const LinearEqualities* equal : problem.equalities) {
    const Vector off = (equal->rows * x - equal->values).cwiseAbs();
    for (Index row = 0; row < off.size(); ++row) {
      if (off[row] > 0) outside.push_back({off[row] / equal->violation_scale, off[row], nullptr, equal, row});
    }
  }
  const std::size_t kept = std::min(outside.size(), static_cast<std::size_t>(count));
  std::partial_sort(outside.begin(), outside.begin() + static_cast<std::ptrdiff_t>(kept), outside.end(),
                    [](const Outside& a, const Outside& b) { return a.relative > b.relative; });
  std::vector<WorstElement> worst;
  for (std::size_t i = 0; i < kept; ++i) worst.push_back(outside[i].named());
  return worst;
}

std::string vertex_name(const Model& model, Index vertex) {
  for (const BodyRange& body : model.bodies) {
    if (vertex >= body.first_vertex && vertex < body.first_vertex + body.vertices) {
      const Index at = vertex - body.first_vertex;
      const std::string level = body.levels == 1 ? "" : " (level " + std::to_string(at % body.levels) + ")";
      return "vertex " + std::to_string(at / body.levels) + level + " of " + body.name;
    }
  }
  return "vertex " + std::to_string(vertex);
}

std::string triangle_name(const Model& model, Index triangle) {
  for (const BodyRange& body : model.bodies) {
    if (triangle >= body.first_triangle && triangle < body.first_triangle + body.triangles) {
      return "triangle " + std::to_string(triangle - body.first_triangle) + " of " + body.name;
    }
  }
  return "triangle " + std::to_string(triangle);
}

void name_for_people(Residuals& residuals, const Problem& problem, const Model& model) {
  constexpr std::string_view prefix = "vertex ";
  if (residuals.worst_node.starts_with(prefix)) {
    const long node = std::stol(residuals.worst_node.substr(prefix.size()));
    residuals.worst_node = model.modal ? "mode " + std::to_string(node + 1) : vertex_name(model, node);
  }
  if (problem.fixed_variables.empty()) return;
  Violation& pins = residuals.violations.back();
  if (pins.element >= 0) pins.where = vertex_name(model, pins.element);
  pins.constraint = pins_name(model);
}

}  // namespace taut
