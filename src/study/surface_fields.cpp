#include "study/surface_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "constraints/strain_limit.h"
#include "energies/membrane.h"
#include "linalg/svd3x2.h"
#include "linalg/symmetric2.h"

namespace taut {
namespace {

const StrainLimitTriangles* strain_limit(const Constraint& constraint) {
  if (const auto* matrix = dynamic_cast<const MatrixStrainLimit*>(&constraint)) return &matrix->limit();
  if (const auto* values = dynamic_cast<const SingularValueStrainLimit*>(&constraint)) return &values->limit();
  return nullptr;
}

double tension_of(const double* multipliers, bool matrix) {
  if (!matrix) return std::max(multipliers[0], multipliers[1]);
  return 2 * eigen2(multipliers[0], multipliers[1] / std::numbers::sqrt2, multipliers[2]).values[0];
}

/// Puts values of a triangle in a field whose name may be new.
template <class Values>
void put(std::vector<Field>& fields, const std::string& name, std::size_t cells, std::size_t cell,
         const Values& values) {
  auto field = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; });
  const auto width = static_cast<std::size_t>(values.size());
  if (field == fields.end()) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    field = fields.insert(field, {name, static_cast<int>(width), std::vector<double>(width * cells, nan)});
  }
  std::copy(values.begin(), values.end(), field->values.begin() + static_cast<std::ptrdiff_t>(cell * width));
}

void add_stresses(const Model& model, const Vector& x, std::vector<Field>& fields) {
  const std::size_t cells = model.triangles.size();
  for (const Model::Shell& shell : model.shells) {
    const ShellSection& section = shell.section;
    const auto first = static_cast<std::size_t>(model.bodies[static_cast<std::size_t>(shell.body)].first_triangle);
    for (int t = 0; t < section.triangles(); ++t) {
      const Resultants resultants = section.resultants(t, x);
      for (const bool top : {false, true}) {
        const std::size_t cell = first + static_cast<std::size_t>(t + (top ? section.triangles() : 0));
        put(fields, "N", cells, cell, resultants.n);
        put(fields, "M", cells, cell, resultants.m);
        put(fields, "Q", cells, cell, resultants.q);
        for (int k = 0; k < section.layers(); ++k) {
          const LayerState state = section.state(t, k, top ? 1 : -1, x);
          put(fields, "stress_" + std::to_string(k), cells, cell, state.stress);
          put(fields, "stretches_" + std::to_string(k), cells, cell, state.stretches);
        }
      }
    }
  }
}

}  // namespace

SurfaceFields::SurfaceFields(const Model& model, bool stresses)
    : model_(model), stresses_(stresses), rest_(model.triangles.size(), nullptr) {
  std::map<Triangle, int> numbers;
  for (std::size_t i = 0; i < model.triangles.size(); ++i) numbers.emplace(model.triangles[i], static_cast<int>(i));
  const auto take_rest = [&](const std::vector<RestTriangle>& triangles) {
    std::vector<int> found;
    for (const RestTriangle& triangle : triangles) {
      found.push_back(numbers.at(triangle.vertices));
      rest_[static_cast<std::size_t>(found.back())] = &triangle;
    }
    return found;
  };
  for (const auto& energy : model.elastic) {
    if (const auto* membrane = dynamic_cast<const Membrane*>(energy.get())) take_rest(membrane->triangles());
  }
  take_rest(model.surfaces);
  for (std::size_t k = 0; k < model.constraints.size(); ++k) {
    const StrainLimitTriangles* limit = strain_limit(*model.constraints[k]);
    if (!limit) continue;
    limits_.push_back({k, model.constraints[k]->rows() == 3, take_rest(limit->triangles)});
    if (std::isfinite(limit->max)) upper_limit_ = std::min(limit->max, upper_limit_.value_or(limit->max));
  }
}

std::vector<Vector2> SurfaceFields::stretches(const Vector& positions) const {
  std::vector<Vector2> values(rest_.size(), Vector2::Constant(std::numeric_limits<double>::quiet_NaN()));
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    if (!rest_[i]) continue;
    Matrix3 corners;
    for (int j = 0; j < 3; ++j) corners.col(j) = positions.segment<3>(3 * rest_[i]->vertices[j]);
    values[i] = singular_values(rest_[i]->deformation_gradient(corners.data()));
  }
  return values;
}

std::vector<double> SurfaceFields::largest_stretch(const Vector& positions) const {
  std::vector<double> largest;
  for (const Vector2& value : stretches(positions)) largest.push_back(value[0]);
  return largest;
}

/// What couplings pull at each vertex with, N: -A^T nu.
Field SurfaceFields::coupling_force(const State& state) const {
  Vector force = Vector::Zero(state.positions.size());
  for (std::size_t k = 0; k < model_.equalities.size(); ++k) {
    const std::size_t at = model_.constraints.size() + k;
    if (at >= state.warm.multipliers.size()) continue;  // before the first step
    force -= model_.equalities[k]->rows.transpose() * state.warm.multipliers[at];
  }
  return {"coupling_force", 3, {force.begin(), force.end()}};
}

Frame SurfaceFields::frame(const State& state, double time) const {
  const std::size_t cells = model_.triangles.size();
  const Vector positions = model_.vertex_positions(state.positions), moved = positions - model_.start(),
               velocities = model_.vertex_velocities(state.positions, state.velocities);
  Field velocity{"velocity", 3, {velocities.begin(), velocities.end()}}, body{"body", 1, {}},
      displacement{"displacement", 3, {moved.begin(), moved.end()}};
  for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
    body.values.insert(body.values.end(), static_cast<std::size_t>(model_.bodies[i].vertices), static_cast<double>(i));
  }
  Field sigma_max{"sigma_max", 1, {}}, sigma_min{"sigma_min", 1, {}};
  for (const Vector2& value : stretches(positions)) {
    sigma_max.values.push_back(value[0]);
    sigma_min.values.push_back(value[1]);
  }
  Field tension{"tension", 1, std::vector<double>(cells, 0)}, active{"active", 1, std::vector<double>(cells, 0)};
  std::vector<char> seen(cells, 0);
  for (const Limit& limit : limits_) {
    if (limit.constraint >= state.warm.multipliers.size()) continue;  // before the first step
    const Vector& multipliers = state.warm.multipliers[limit.constraint];
    const int rows = limit.matrix ? 3 : 2;
    for (std::size_t e = 0; e < limit.triangles.size(); ++e) {
      const auto triangle = static_cast<std::size_t>(limit.triangles[e]);
      const auto row = static_cast<Index>(e) * rows;
      const double value = tension_of(multipliers.data() + row, limit.matrix);
      const bool first = !std::exchange(seen[triangle], 1);
      tension.values[triangle] = first ? value : std::max(tension.values[triangle], value);
      if (!multipliers.segment(row, rows).isZero(0)) active.values[triangle] = 1;
    }
  }
  Frame frame{
      time, positions, model_.triangles, {velocity, body, displacement}, {sigma_max, sigma_min, tension, active}};
  if (stresses_) add_stresses(model_, positions, frame.cell_fields);
  if (!model_.equalities.empty()) frame.point_fields.push_back(coupling_force(state));
  return frame;
}

}  // namespace taut
