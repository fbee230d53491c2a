#include "study/verdicts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "dynamics/modal/warped_position.h"
#include "study/examine.h"

namespace taut {
namespace {

constexpr double largest_slenderness = 1e4;

Vector3 area_vector(const Triangle& t, const Vector& x) {
  const auto at = [&](int corner) { return x.segment<3>(3 * t[corner]); };
  return (at(1) - at(0)).cross(at(2) - at(0));
}

double longest_edge_squared(const Triangle& t, const Vector& x) {
  double longest = 0;
  for (int i = 0; i < 3; ++i) {
    longest = std::max(longest, (x.segment<3>(3 * t[(i + 1) % 3]) - x.segment<3>(3 * t[i])).squaredNorm());
  }
  return longest;
}

/// The element that has the 99th percentile is the one with rank ceil(0.99 n).
template <typename Name>
Verdict verdict_over(std::string constraint, std::vector<double> values, double allowed, Name name) {
  Verdict verdict;
  verdict.constraint = std::move(constraint);
  verdict.allowed = allowed;
  verdict.elements = static_cast<Index>(values.size());
  if (values.empty()) return verdict;
  verdict.violated = std::count_if(values.begin(), values.end(), [allowed](double v) { return !(v <= allowed); });
  const auto worst = std::max_element(values.begin(), values.end());
  verdict.max = *worst;
  if (verdict.max > 0) verdict.where = name(worst - values.begin());
  const auto rank = values.begin() + static_cast<std::ptrdiff_t>((99 * values.size() + 99) / 100 - 1);
  std::nth_element(values.begin(), rank, values.end());
  verdict.percentile99 = *rank;
  return verdict;
}

/// At positions of vertices.
std::vector<double> violations(const Constraint& constraint, const Vector& x) {
  std::array<double, max_stencil_width> local;
  std::vector<double> values;
  if (const auto* warped = dynamic_cast<const WarpedPosition*>(&constraint)) {
    for (std::size_t k = 0; k < warped->held().size(); ++k) {
      const auto [node, axis] = warped->held()[k];
      values.push_back(std::abs(x[3 * node + axis] - warped->targets()[static_cast<Index>(k)]));
    }
    return values;
  }
  for (Index element = 0; element < constraint.stencils().count(); ++element) {
    constraint.stencils().gather(element, x, local.data());
    values.push_back(constraint.violation(element, local.data()));
  }
  return values;
}

/// Of each triangle, those across an edge whose area vectors are within 90 degrees of its own at x.
std::vector<std::vector<int>> unfolded_neighbours(const std::vector<Triangle>& triangles, const Vector& x) {
  std::map<std::pair<int, int>, int> owners;  // of directed edges
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) owners[{triangles[t][i], triangles[t][(i + 1) % 3]}] = static_cast<int>(t);
  }
  std::vector<std::vector<int>> neighbours(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      const auto across = owners.find({triangles[t][(i + 1) % 3], triangles[t][i]});
      if (across == owners.end()) continue;
      const Triangle& other = triangles[static_cast<std::size_t>(across->second)];
      if (area_vector(triangles[t], x).dot(area_vector(other, x)) >= 0) neighbours[t].push_back(across->second);
    }
  }
  return neighbours;
}

}  // namespace

PositionJudge::PositionJudge(Model& model, double tolerance)
    : model_(model), tolerance_(tolerance), neighbours_(unfolded_neighbours(model.triangles, model.start())) {
  const Vector start = model.start();
  const Eigen::Map<const Eigen::Matrix3Xd> points(start.data(), 3, start.size() / 3);
  size_ = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

std::vector<Verdict> PositionJudge::constraints(const Vector& x, double time) const {
  for (const auto& mover : model_.movers) mover(time);
  std::vector<Verdict> verdicts;
  for (const auto& constraint : model_.constraints) {
    verdicts.push_back(verdict_over(constraint->name(), violations(*constraint, x),
                                    tolerance_ * constraint->violation_scale(),
                                    [&](Index element) { return constraint->element_name(element); }));
  }
  for (const auto& equal : model_.equalities) {
    const Vector off = (equal->rows * x - equal->values).cwiseAbs();
    verdicts.push_back(
        verdict_over(equal->name, {off.begin(), off.end()}, tolerance_ * equal->violation_scale, equal->row_name));
  }
  if (!model_.pins.empty()) verdicts.push_back(pins(x, time));
  return verdicts;
}

Verdict PositionJudge::pins(const Vector& x, double time) const {
  std::vector<int> vertices;
  std::vector<double> values;
  for (const PinnedVariable& pin : model_.pins) {  // in ascending order, so that those of a vertex are together
    const int vertex = pin.variable / 3;
    if (vertices.empty() || vertices.back() != vertex) {
      vertices.push_back(vertex);
      values.push_back(0);
    }
    values.back() = std::max(values.back(), std::abs(x[pin.variable] - pin.value(time)));
  }
  return verdict_over(pins_name(model_), std::move(values), tolerance_ * size_,
                      [&](Index pin) { return vertex_name(model_, vertices[static_cast<std::size_t>(pin)]); });
}

std::vector<Verdict> PositionJudge::faces(const Vector& x, double largest_fold) const {
  std::vector<Vector3> normals;
  std::vector<double> folds, slenderness;
  for (const Triangle& triangle : model_.triangles) {
    const Vector3 area = area_vector(triangle, x);
    slenderness.push_back(area.isZero(0) ? std::numeric_limits<double>::infinity()
                                         : longest_edge_squared(triangle, x) / area.norm());
    normals.push_back(area.normalized());  // zero without area, at a right angle to everything
  }
  for (std::size_t t = 0; t < normals.size(); ++t) {
    std::vector<double> cosines;
    for (const int other : neighbours_[t]) cosines.push_back(normals[t].dot(normals[static_cast<std::size_t>(other)]));
    std::sort(cosines.begin(), cosines.end());
    const double cosine = cosines.size() < 2 ? 1.0 : std::clamp(cosines[1], -1.0, 1.0);
    folds.push_back(std::acos(cosine) * 180 / std::numbers::pi);
  }
  const auto name = [this](Index triangle) { return triangle_name(model_, triangle); };
  return {verdict_over("inverted faces", std::move(folds), largest_fold, name),
          verdict_over("degenerate faces", std::move(slenderness), largest_slenderness, name)};
}

}  // namespace taut
