#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/problem.h"
#include "dynamics/model.h"
#include "problems/scene.h"

namespace taut {

/// A probe's latest value and what it should be.
struct ProbeValue {
  std::string name;
  double value = 0;  ///< NaN before the first step
  std::optional<scene::Expected> expected;

  /// Largest difference from the expected value.
  double allowed() const;
  /// True without an expected value.
  bool within() const;
};

/// The probes of a scene without values.
std::vector<ProbeValue> probes_of(const Scene& scene);

/// The values of the scene's probes at x, in their order; `problem` is that of the step which ends there. Forces are
/// the sum of all nodal forces of the problem's energies, inertia among them, with the opposite sign: what supports and
/// constraints add to the vertices.
std::vector<double> probe_values(const Scene& scene, const Model& model, const Problem& problem, const Vector& x);

}  // namespace taut
