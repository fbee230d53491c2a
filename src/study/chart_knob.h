#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "problems/read_scene.h"

namespace taut {

/// What a chart turns from point to point.
enum class KnobKind {
  none,        ///< every solver once, on the problem as it is
  tolerance,   ///< all three of solver.tolerance
  step,        ///< time.step, to the same end time; of static problems the share of the load that one step adds
  mesh,        ///< the cells of every grid, times a factor
  integrator,  ///< time.integrator
  penalty,     ///< the first penalty of augmented Lagrangians
  model,       ///< a problem file each, or a list of overrides
  key          ///< any other key of the problem
};

/// As the command line has it: "tolerance", "mesh=0.5,1,2", "constraints.limit.max=1.05,1.1".
struct KnobChoice {
  KnobKind kind = KnobKind::none;
  std::string name;                 ///< "tolerance", "constraints.limit.max"; empty for KnobKind::none
  std::vector<std::string> values;  ///< none: what values_of() finds suitable
};

/// Throws InputError for anything else.
KnobChoice parse_knob(const std::string& text);

struct KnobValue {
  std::string label;                                         ///< "1e-06", "8x8", "bdf2"
  double number = std::numeric_limits<double>::quiet_NaN();  ///< tolerance; step, s; width of cells relative to the
                                                             ///< problem's own; penalty; else NaN where it is none
  std::string problem;                                       ///< of a model: another file or name; else empty
  Overrides overrides;
};

/// The values of a knob for a problem, coarse and fine as they are given. Throws InputError for values that do not fit
/// it: steps that do not divide the time, factors that leave no whole cells, meshes from files.
std::vector<KnobValue> values_of(const KnobChoice& choice, const Scene& scene);

/// The value of a knob that is turned by numbers (tolerance, step, mesh, penalty). Throws as above.
KnobValue numbered_value(KnobKind kind, double number, const Scene& scene);

/// True where another value poses the same problem, so that all have one solution.
bool keeps_the_problem(const KnobChoice& choice);

}  // namespace taut
