#include "study/chart_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "problems/build.h"

namespace taut {
namespace {

/// A vertex by its body and its rounded place.
using Place = std::pair<std::string, std::array<long long, 3>>;

/// Coordinates are rounded with an offset, so that those of regular grids do not lie between two roundings.
Place place_of(const std::string& body, const Vector3& x, double size) {
  constexpr double resolution = 1e6, offset = 0.3819660;
  Place place{body, {}};
  for (int axis = 0; axis < 3; ++axis)
    place.second[static_cast<std::size_t>(axis)] = std::llround(resolution * x[axis] / size + offset);
  return place;
}

std::map<Place, BodyPoint> places_of(const StartingPoints& scene, double size) {
  std::map<Place, BodyPoint> places;
  const auto at = [&scene](int vertex) { return scene.positions.segment<3>(3 * vertex); };
  const auto add = [&](const BodyRange& body, int a, int b) {
    places.emplace(place_of(body.name, (at(a) + at(b)) / 2, size), BodyPoint{a, b});
  };
  for (const BodyRange& body : scene.bodies) {
    for (int vertex = 0; vertex < body.vertices; ++vertex)
      add(body, body.first_vertex + vertex, body.first_vertex + vertex);
    if (body.levels == 1) continue;
    for (int bottom = 0; bottom < body.vertices; bottom += body.levels)
      add(body, body.first_vertex + bottom, body.first_vertex + bottom + body.levels - 1);
  }
  return places;
}

bool is_length(scene::Quantity quantity) {
  return quantity == scene::Quantity::position || quantity == scene::Quantity::displacement ||
         quantity == scene::Quantity::displacement_length;
}

/// A length is measured against the scene, unless the file says that it wants it relative; anything else is relative.
double scale_of(const scene::Probe& probe, double size) {
  const bool relative = probe.expected ? probe.expected->relative : !is_length(probe.quantity);
  return relative || !is_length(probe.quantity) ? 0 : std::abs(probe.factor) * size;
}

Vector end_positions(const StoredRun& run) {
  const bool modal = std::any_of(run.scene.bodies.begin(), run.scene.bodies.end(),
                                 [](const scene::Body& body) { return body.modal.has_value(); });
  const Vector& x = run.checkpoint.state.positions;
  return modal ? build_model(run.scene)->vertex_positions(x) : x;
}

}  // namespace

std::vector<std::vector<BodyPoint>> common_points(const std::vector<StartingPoints>& scenes, double size) {
  std::vector<std::map<Place, BodyPoint>> places;
  places.reserve(scenes.size());
  for (const StartingPoints& scene : scenes) places.push_back(places_of(scene, size));
  std::vector<std::vector<BodyPoint>> common(scenes.size());
  if (scenes.empty()) return common;
  for (const auto& [place, unused] : places.front()) {
    const bool everywhere =
        std::all_of(places.begin(), places.end(), [&](const auto& other) { return other.contains(place); });
    if (!everywhere) continue;
    for (std::size_t k = 0; k < scenes.size(); ++k) common[k].push_back(places[k].at(place));
  }
  return common;
}

double ErrorMeasure::operator()(const Vector& result, const Vector& reference) const {
  double largest = 0;
  const auto raise = [&](double value) {
    if (!(value <= largest)) largest = value;
  };
  switch (kind) {
    case ErrorKind::position:
      for (Index k = 0; k < reference.size(); k += 3)
        raise((result.segment<3>(k) - reference.segment<3>(k)).norm() / size);
      break;
    case ErrorKind::energy:
      raise(std::abs(result[0] - reference[0]) / reference[1]);
      break;
    case ErrorKind::probe:
      for (Index k = 0; k < reference.size(); ++k) {
        const double given = probe_scales[static_cast<std::size_t>(k)];
        const double scale = given > 0 ? given : reference[k] != 0 ? std::abs(reference[k]) : 1;
        raise(std::abs(result[k] - reference[k]) / scale);
      }
      break;
    case ErrorKind::violation:
      throw std::logic_error("ErrorMeasure: a violation has no reference");
  }
  return largest;
}

ErrorMeasure error_measure(ErrorKind kind, const Scene& scene, double size) {
  ErrorMeasure measure{.kind = kind, .size = size, .probes = {}, .probe_scales = {}, .expected = {}, .source = ""};
  if (kind != ErrorKind::probe) return measure;
  const std::vector<scene::Probe>& probes = scene.output.probes;
  if (probes.empty()) throw InputError(scene.source, "/output/probes", "found none, --error probe needs at least one");
  const bool closed =
      std::any_of(probes.begin(), probes.end(), [](const scene::Probe& probe) { return probe.expected.has_value(); });
  std::vector<double> expected;
  for (const scene::Probe& probe : probes) {
    if (closed && !probe.expected) continue;
    measure.probes.push_back(probe.name);
    measure.probe_scales.push_back(scale_of(probe, size));
    if (!closed) continue;
    expected.push_back(probe.expected->value);
    const std::string& source = probe.expected->source;
    if (measure.source.find(source) == measure.source.npos)
      measure.source += (measure.source.empty() ? "" : "; ") + source;
  }
  if (closed) measure.expected = Eigen::Map<const Vector>(expected.data(), static_cast<Index>(expected.size()));
  return measure;
}

std::optional<Vector> observe(const StoredRun& run, const ErrorMeasure& measure, const std::vector<BodyPoint>& points) {
  if (run.checkpoint.state.step != run.scene.time.steps) return {};
  std::vector<double> values;
  switch (measure.kind) {
    case ErrorKind::position: {
      const Vector x = end_positions(run);
      for (const auto& [a, b] : points)
        for (int axis = 0; axis < 3; ++axis) values.push_back((x[3 * a + axis] + x[3 * b + axis]) / 2);
      break;
    }
    case ErrorKind::energy: {
      double sum = 0, magnitude = 0;
      for (const auto& [name, energy] : run.steps.back().energies) {
        sum += energy;
        magnitude += std::abs(energy);
      }
      values = {sum, magnitude};
      break;
    }
    case ErrorKind::probe:
      for (const std::string& name : measure.probes) {
        const auto probe = std::find_if(run.summary.probes.begin(), run.summary.probes.end(),
                                        [&](const ProbeValue& one) { return one.name == name; });
        if (probe == run.summary.probes.end()) return {};
        values.push_back(probe->value);
      }
      break;
    case ErrorKind::violation:
      return {};
  }
  const Vector observed = Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
  return observed.allFinite() ? std::optional(observed) : std::nullopt;
}

}  // namespace taut
