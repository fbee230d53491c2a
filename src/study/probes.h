#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/problem.h"
#include "dynamics/modal/natural_modes.h"
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
/// constraints add to the vertices. Frequencies are those of `modes`, NaN where it has too few.
std::vector<double> probe_values(const Scene& scene, const Model& model, const Problem& problem, const Vector& x,
                                 const std::vector<NaturalMode>& modes = {});

/// The modes that the scene asks for about x, the end of `step`; none before the last step. Throws std::runtime_error
/// where they are not found.
std::vector<NaturalMode> modes_at(const Scene& scene, const Model& model, const Problem& problem, const Vector& x,
                                  int step, int threads);

}  // namespace taut
