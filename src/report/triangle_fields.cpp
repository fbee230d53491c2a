#include "report/triangle_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "constraints/obstacle.h"
#include "study/examine.h"

namespace taut {
namespace {

constexpr std::size_t worst_kept = 5;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::vector<int>> triangles_at_vertices(const Model& model) {
  std::vector<std::vector<int>> at(static_cast<std::size_t>(model.start().size() / 3));
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    for (const int vertex : model.triangles[t]) at[static_cast<std::size_t>(vertex)].push_back(static_cast<int>(t));
  }
  return at;
}

/// Of each element of a constraint on vertices, the triangles that contain its vertices or are contained in them.
std::vector<std::vector<int>> triangles_of_elements(const Model& model, const Stencils& stencils,
                                                    const std::vector<std::vector<int>>& at_vertices) {
  std::vector<std::vector<int>> lists;
  for (Index element = 0; element < stencils.count(); ++element) {
    std::set<int> vertices;
    for (int i = 0; i < stencils.width(); ++i) vertices.insert(stencils[element][i] / 3);
    std::set<int> found;
    for (const int vertex : vertices) {
      for (const int t : at_vertices[static_cast<std::size_t>(vertex)]) {
        const Triangle& corners = model.triangles[static_cast<std::size_t>(t)];
        const auto shared = std::count_if(corners.begin(), corners.end(), [&](int v) { return vertices.contains(v); });
        if (shared == std::min<std::ptrdiff_t>(3, std::ssize(vertices))) found.insert(t);
      }
    }
    lists.emplace_back(found.begin(), found.end());
  }
  return lists;
}

WorstPlace place_of(const TriangleField& field, std::string element, double value, int frame,
                    std::vector<int> triangles) {
  return {field.id, field.title, field.unit, std::move(element), value, frame, std::move(triangles)};
}

/// The triangles of largest value, each in its worst frame.
void add_worst_triangles(const TriangleField& field, const Model& model, std::vector<WorstPlace>& places) {
  const std::size_t cells = model.triangles.size();
  std::vector<double> largest(cells, -std::numeric_limits<double>::infinity());
  std::vector<int> frame(cells, 0), order;
  for (std::size_t f = 0; f < field.frames.size(); ++f) {
    for (std::size_t t = 0; t < cells; ++t) {
      if (field.frames[f][t] > largest[t]) largest[t] = field.frames[f][t], frame[t] = static_cast<int>(f);
    }
  }
  for (std::size_t t = 0; t < cells; ++t) {
    if (std::isfinite(largest[t])) order.push_back(static_cast<int>(t));
  }
  const auto end = order.begin() + static_cast<std::ptrdiff_t>(std::min(worst_kept, order.size()));
  std::partial_sort(order.begin(), end, order.end(), [&](int a, int b) {
    return largest[static_cast<std::size_t>(a)] > largest[static_cast<std::size_t>(b)] ||
           (largest[static_cast<std::size_t>(a)] == largest[static_cast<std::size_t>(b)] && a < b);
  });
  for (auto it = order.begin(); it != end; ++it) {
    const auto t = static_cast<std::size_t>(*it);
    places.push_back(place_of(field, triangle_name(model, *it), largest[t], frame[t], {*it}));
  }
}

}  // namespace

std::pair<double, double> TriangleField::extremes() const {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const auto& frame : frames) {
    for (const double value : frame) {
      if (std::isfinite(value)) least = std::min(least, value), most = std::max(most, value);
    }
  }
  return least <= most ? std::pair{least, most} : std::pair{0.0, 0.0};
}

TriangleFields::TriangleFields(const Model& model)
    : model_(model),
      surface_(model),
      stretch_{"sigma_max", "largest singular value", "", 1.0, surface_.upper_limit(), {}},
      tension_{"tension", "tension", "N/m", 0.0, {}, {}} {
  if (stretch_.high && *stretch_.high <= 1) stretch_.low.reset();
  if (model.modal) return;  // constraints are on modes
  const auto at_vertices = triangles_at_vertices(model);
  for (const auto& constraint : model.constraints) {
    const bool lengths = dynamic_cast<const Obstacle*>(constraint.get()) != nullptr;
    const auto elements = static_cast<std::size_t>(constraint->stencils().count());
    violations_.push_back(
        {constraint.get(),
         triangles_of_elements(model, constraint->stencils(), at_vertices),
         std::vector<double>(elements, 0),
         std::vector<int>(elements, 0),
         {"violation_" + constraint->name(), "violation of " + constraint->name(), lengths ? "m" : "", 0.0, {}, {}}});
  }
}

void TriangleFields::take(const Frame& frame) {
  stretch_.frames.push_back(surface_.largest_stretch(frame.positions));
  const auto tension = std::find_if(frame.cell_fields.begin(), frame.cell_fields.end(),
                                    [](const Field& field) { return field.name == "tension"; });
  tension_.frames.push_back(tension == frame.cell_fields.end() ? std::vector<double>(model_.triangles.size(), nan)
                                                               : tension->values);
  for (Violations& violations : violations_) take_violations(violations, frame.positions);
  ++frames_;
}

void TriangleFields::take_violations(Violations& violations, const Vector& positions) {
  const Constraint& constraint = *violations.constraint;
  auto& values = violations.field.frames.emplace_back(model_.triangles.size(), nan);
  std::array<double, max_stencil_width> local;
  for (Index element = 0; element < constraint.stencils().count(); ++element) {
    constraint.stencils().gather(element, positions, local.data());
    const double violation = constraint.violation(element, local.data());
    const auto e = static_cast<std::size_t>(element);
    if (violation > violations.largest[e]) violations.largest[e] = violation, violations.frame[e] = frames_;
    for (const int t : violations.triangles[e]) {
      double& value = values[static_cast<std::size_t>(t)];
      value = std::isnan(value) ? violation : std::max(value, violation);
    }
  }
}

std::vector<TriangleField> TriangleFields::fields() const {
  std::vector<TriangleField> fields{stretch_};
  if (tension_.extremes().second > 0) fields.push_back(tension_);
  for (const Violations& violations : violations_) {
    if (violations.field.extremes().second > 0) fields.push_back(violations.field);
  }
  return fields;
}

std::vector<WorstPlace> TriangleFields::worst() const {
  std::vector<WorstPlace> places;
  for (const Violations& violations : violations_) {
    std::vector<std::size_t> order;
    for (std::size_t e = 0; e < violations.largest.size(); ++e) {
      if (violations.largest[e] > 0 && !violations.triangles[e].empty()) order.push_back(e);
    }
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return violations.largest[a] > violations.largest[b]; });
    order.resize(std::min(order.size(), worst_kept));
    for (const std::size_t e : order) {
      places.push_back(place_of(violations.field, violations.constraint->element_name(static_cast<Index>(e)),
                                violations.largest[e], violations.frame[e], violations.triangles[e]));
    }
  }
  add_worst_triangles(stretch_, model_, places);
  if (tension_.extremes().second > 0) add_worst_triangles(tension_, model_, places);
  return places;
}

}  // namespace taut
