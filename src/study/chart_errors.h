#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "dynamics/model.h"
#include "problems/scene.h"
#include "study/chart_records.h"
#include "study/richardson.h"
#include "study/stored_run.h"

namespace taut {

/// The vertices of a scene at the start.
struct StartingPoints {
  std::vector<BodyRange> bodies;
  Vector positions;  ///< m, 3 entries each
};

/// A place of a body: a vertex (twice), or the middle between one on the bottom of a thick shell and that on its top,
/// which is where a sheet in its place would be.
using BodyPoint = std::array<int, 2>;

/// For each scene its points that all scenes have: in bodies of one name, at the same place at the start within 1e-6 of
/// `size` (m), in an order that is the same for all. Empty lists where there are none.
std::vector<std::vector<BodyPoint>> common_points(const std::vector<StartingPoints>& scenes, double size);

/// What the ends of runs are compared by.
struct ErrorMeasure {
  ErrorKind kind = ErrorKind::position;
  double size = 0;                   ///< of the scene, m
  std::vector<std::string> probes;   ///< which, for ErrorKind::probe
  std::vector<double> probe_scales;  ///< one each; 0: the reference's magnitude
  std::optional<Vector> expected;    ///< closed form of the probes
  std::string source;                ///< of the closed form

  /// The error of what one run's end has against that of the reference, both as observe() gives them.
  double operator()(const Vector& result, const Vector& reference) const;
};

/// Errors of this kind on a scene. Probes with an expected value have a closed form; where there are any, only they
/// count. Throws InputError for probes where the scene has none.
ErrorMeasure error_measure(ErrorKind kind, const Scene& scene, double size);

/// What `measure` compares of a run's end; nothing where the run did not reach it. `points` are those of
/// common_points(). Throws InputError for a scene that cannot be built.
std::optional<Vector> observe(const StoredRun& run, const ErrorMeasure& measure, const std::vector<BodyPoint>& points);

}  // namespace taut
