#include "study/quantity_of_interest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>

#include "geometry/distance.h"
#include "geometry/prolongation.h"
#include "problems/build.h"
#include "study/middle_surface.h"
#include "study/peak_tension.h"

namespace taut {
namespace {

using Kind = QuantityOfInterest::Kind;
constexpr std::size_t most_points = 2000;  // of a body

const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> all{{"probe", Kind::probe},     {"displacement", Kind::displacement},
                                               {"shape", Kind::shape},     {"frequency", Kind::frequency},
                                               {"tension", Kind::tension}, {"energy", Kind::energy}};
  return all;
}

[[noreturn]] void refuse_quantity(const std::string& found) {
  throw InputError("--quantity " + found +
                   ": allowed: probe:NAME, displacement, shape, frequency:K, tension, energy, energy:NAME");
}

/// Every unit a tolerance may have, with its value in SI and whose unit it is.
struct Unit {
  const char* name;
  double value;
  std::vector<Kind> of;
};

const std::vector<Unit>& units() {
  static const std::vector<Unit> all{{"mm", 1e-3, {Kind::displacement, Kind::shape}},
                                     {"cm", 1e-2, {Kind::displacement, Kind::shape}},
                                     {"m", 1, {Kind::displacement, Kind::shape}},
                                     {"Hz", 1, {Kind::frequency}},
                                     {"N/m", 1, {Kind::tension}},
                                     {"mJ", 1e-3, {Kind::energy}},
                                     {"J", 1, {Kind::energy}}};
  return all;
}

std::string names_of_probes(const Scene& scene) {
  std::string text;
  for (const scene::Probe& probe : scene.output.probes) text += (text.empty() ? "" : ", ") + probe.name;
  return text.empty() ? "none, as the problem has no probes" : text;
}

Answer number(double value, double magnitude) { return {Vector::Constant(1, value), magnitude}; }

/// Vertices of the triangles, evenly thinned out.
std::vector<Vector3> material_points(const TriangleMesh& mesh) {
  std::vector<int> used;
  for (const Triangle& triangle : mesh.triangles) used.insert(used.end(), triangle.begin(), triangle.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const std::size_t stride = (used.size() + most_points - 1) / most_points;
  std::vector<Vector3> points;
  for (std::size_t k = 0; k < used.size(); k += stride)
    points.push_back(mesh.vertices[static_cast<std::size_t>(used[k])]);
  return points;
}

/// A cover that a simpler model leaves out lies on its shell.
const BodyRange& range_of(const Model& model, const std::string& name) {
  for (const std::string& wanted : {name, name.substr(0, name.find('/'))}) {
    for (const BodyRange& body : model.bodies)
      if (body.name == wanted) return body;
  }
  throw InputError(model.name + ": has no body " + name);
}

Vector end_positions(const Model& model, const StoredRun& run) {
  return model.vertex_positions(run.checkpoint.state.positions);
}

Answer largest_displacement(const StoredRun& run) {
  const auto model = build_model(run.scene);
  const Vector moved = end_positions(*model, run) - model->start();
  const double largest = moved.reshaped(3, moved.size() / 3).colwise().norm().maxCoeff();
  return number(largest, largest);
}

Answer energy_of(const StoredRun& run, const std::string& name) {
  double sum = 0, magnitude = 0;
  for (const auto& [energy, value] : run.steps.back().energies) {
    if (!name.empty() && energy != name) continue;  // one that a simpler model leaves out is zero
    sum += value;
    magnitude += std::abs(value);
  }
  return number(sum, magnitude);
}

Answer probe_of(const StoredRun& run, const std::string& name) {
  for (const ProbeValue& probe : run.summary.probes)
    if (probe.name == name) return number(probe.value, std::abs(probe.value));
  return number(std::nan(""), 0);
}

Answer frequency_of(const StoredRun& run, int mode) {
  if (mode > static_cast<int>(run.summary.modes.size())) return number(std::nan(""), 0);
  const double frequency = run.summary.modes[static_cast<std::size_t>(mode) - 1].frequency;
  return number(frequency, frequency);
}

}  // namespace

std::string QuantityOfInterest::text() const {
  std::string word;
  for (const auto& [text, value] : kinds())
    if (value == kind) word = text;
  if (kind == Kind::frequency) return word + ":" + std::to_string(mode);
  return name.empty() ? word : word + ":" + name;
}

std::string QuantityOfInterest::unit() const {
  for (const Unit& unit : units())
    if (unit.value == 1 && std::count(unit.of.begin(), unit.of.end(), kind) > 0) return unit.name;
  return "";
}

QuantityOfInterest parse_quantity(const std::string& text) {
  const std::size_t colon = text.find(':');
  const auto kind = kinds().find(text.substr(0, colon));
  if (kind == kinds().end()) refuse_quantity(text);
  QuantityOfInterest quantity;
  quantity.kind = kind->second;
  const std::string after = colon == text.npos ? "" : text.substr(colon + 1);
  const bool named = quantity.kind == Kind::probe || quantity.kind == Kind::energy;
  if (after.empty() ? colon != text.npos || quantity.kind == Kind::probe : !named && quantity.kind != Kind::frequency)
    refuse_quantity(text);
  if (named) quantity.name = after;
  if (quantity.kind != Kind::frequency || after.empty()) return quantity;
  char* end = nullptr;
  const long mode = std::strtol(after.c_str(), &end, 10);
  if (*end != '\0' || mode < 1 || mode > 1000) refuse_quantity(text);
  quantity.mode = static_cast<int>(mode);
  return quantity;
}

void check_quantity(const QuantityOfInterest& quantity, const Scene& scene) {
  const std::string option = "--quantity " + quantity.text();
  if (quantity.kind == Kind::probe) {
    const auto& probes = scene.output.probes;
    const bool there = std::any_of(probes.begin(), probes.end(),
                                   [&](const scene::Probe& probe) { return probe.name == quantity.name; });
    if (!there) throw InputError(scene.source, "/output/probes", option + ": allowed: " + names_of_probes(scene));
  }
  if (quantity.kind == Kind::frequency && scene.time.integrator != scene::Integrator::quasi_static)
    throw InputError(scene.source, "/time/integrator", option + ": found a dynamic problem, allowed: static");
}

AnswerTolerance parse_tolerance(const std::string& text, const QuantityOfInterest& quantity) {
  std::string allowed = "5%, 0.05, abs:X in the unit of the quantity";
  for (const Unit& unit : units())
    if (std::count(unit.of.begin(), unit.of.end(), quantity.kind) > 0) allowed += std::string(", X") + unit.name;
  const auto refuse = [&]() -> InputError {
    return InputError("--tolerance " + text + ": allowed for " + quantity.text() + ": " + allowed);
  };
  const bool absolute = text.starts_with("abs:");
  const std::string digits = absolute ? text.substr(4) : text;
  char* end = nullptr;
  const double value = std::strtod(digits.c_str(), &end);
  const std::string after = end;
  if (end == digits.c_str() || !(value > 0) || !std::isfinite(value)) throw refuse();
  if (absolute) {
    if (!after.empty()) throw refuse();
    return {value, false};
  }
  if (after.empty()) return {value, true};
  if (after == "%") return {value / 100, true};
  for (const Unit& unit : units()) {
    if (after == unit.name && std::count(unit.of.begin(), unit.of.end(), quantity.kind) > 0)
      return {value * unit.value, false};
  }
  throw refuse();
}

double distance(const Answer& a, const Answer& b) {
  if (a.values.size() != b.values.size()) return std::numeric_limits<double>::infinity();
  const double points = a.values.size() == 1 ? 1 : static_cast<double>(a.values.size()) / 3;
  return (a.values - b.values).norm() / std::sqrt(points);
}

Observer::Observer(QuantityOfInterest quantity, const Scene& full) : quantity_(std::move(quantity)) {
  check_quantity(quantity_, full);
  const auto model = build_model(full);
  if (quantity_.kind == Kind::tension && !has_tension(*model))
    throw InputError(full.source, "/bodies", "--quantity tension: allowed: bodies with a membrane, or thick shells");
  if (quantity_.kind == Kind::energy && !quantity_.name.empty()) {
    Stepper stepper(*model, time_options(full));
    std::string names;
    bool there = false;
    for (const auto& [name, unused] : stepper.energies()) {
      there = there || name == quantity_.name;
      names += (names.empty() ? "" : ", ") + name;
    }
    if (!there) throw InputError(full.source, "/bodies", "--quantity " + quantity_.text() + ": allowed: " + names);
  }
  if (quantity_.kind != Kind::shape) return;
  for (const BodyRange& body : model->bodies)
    points_.push_back({body.name, material_points(middle_surface(*model, body, model->start()).start)});
}

Answer Observer::shape(const StoredRun& run) const {
  const auto model = build_model(run.scene);
  const Vector end = end_positions(*model, run);
  std::vector<double> values;
  for (const MaterialPoints& points : points_) {
    const MiddleSurface surface = middle_surface(*model, range_of(*model, points.body), end);
    const std::vector<int> nearest = nearest_triangles(surface.start, points.places);
    for (std::size_t k = 0; k < points.places.size(); ++k) {
      const Triangle& t = surface.start.triangles[static_cast<std::size_t>(nearest[k])];
      const auto corner = [&](int j) { return static_cast<std::size_t>(t[static_cast<std::size_t>(j)]); };
      const auto& vertices = surface.start.vertices;
      const Vector3 weights =
          point_triangle_distance(points.places[k], vertices[corner(0)], vertices[corner(1)], vertices[corner(2)])
              .weights;
      Vector3 moved = Vector3::Zero();
      for (int j = 0; j < 3; ++j) moved += weights[j] * surface.moved[corner(j)];
      values.insert(values.end(), moved.begin(), moved.end());
    }
  }
  Answer answer{Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size())), 0};
  answer.magnitude = answer.values.norm() / std::sqrt(static_cast<double>(values.size()) / 3);
  return answer;
}

std::optional<Answer> Observer::operator()(const StoredRun& run) const {
  if (run.checkpoint.state.step != run.scene.time.steps) return {};
  const auto answer = [&]() -> Answer {
    switch (quantity_.kind) {
      case Kind::probe:
        return probe_of(run, quantity_.name);
      case Kind::displacement:
        return largest_displacement(run);
      case Kind::shape:
        return shape(run);
      case Kind::frequency:
        return frequency_of(run, quantity_.mode);
      case Kind::tension: {
        const auto model = build_model(run.scene);
        const double tension = peak_tension(*model, run.checkpoint.state);
        return number(tension, std::abs(tension));
      }
      case Kind::energy:
        return energy_of(run, quantity_.name);
    }
    return number(std::nan(""), 0);
  }();
  return answer.values.allFinite() ? std::optional(answer) : std::nullopt;
}

}  // namespace taut
