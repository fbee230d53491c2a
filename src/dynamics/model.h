#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/constraint.h"
#include "core/energy.h"
#include "core/linear_equalities.h"
#include "energies/dead_load.h"
#include "energies/end_moment.h"
#include "energies/inertia.h"
#include "energies/pressure.h"
#include "energies/shell_section.h"
#include "energies/stiffness_damping.h"
#include "geometry/rest_shape.h"
#include "geometry/triangle_mesh.h"

namespace taut {

struct ModalBasis;
class WarpedLoad;

/// A body's share of the scene's vertices and triangles. A thick shell has `levels` of vertices one over the other at
/// each vertex of its mesh, and the triangles of its bottom, then those of its top.
struct BodyRange {
  std::string name;
  int first_vertex = 0, vertices = 0;
  int first_triangle = 0, triangles = 0;
  int levels = 1;
};

/// A held coordinate: x[variable] follows its value at every time.
struct PinnedVariable {
  int variable = 0;
  std::function<double(double time)> value;  ///< m at time in s (static: load fraction)
};

/// A scene as energies and constraints, with nothing in it that depends on the time integrator. Vertex v has the
/// variables 3v, 3v+1, 3v+2, unless the unknowns are those of modes.
struct Model {
  std::string name;
  std::vector<BodyRange> bodies;
  std::vector<Triangle> triangles;  ///< of all bodies, scene vertex indices
  Vector positions, velocities;     ///< at the start; m and m/s, 3 entries a vertex

  std::vector<RestTriangle> surfaces;  ///< outer surfaces of thick shells at rest; their vertices are in `triangles`

  struct Shell {
    int body;
    ShellSection section;
  };
  std::vector<Shell> shells;  ///< one per thick shell; their layers are among `elastic`

  std::vector<std::unique_ptr<Inertia>> inertia;  ///< one per body with mass, or per layer of a thick shell
  std::vector<double> mass_damping;               ///< 1/s, one per inertia
  std::vector<std::unique_ptr<Energy>> elastic;   ///< membrane, bending, layers of thick shells
  struct RayleighDamping {
    std::unique_ptr<StiffnessDamping> energy;
    double beta;  ///< s
  };
  std::vector<RayleighDamping> stiffness_damping;
  std::vector<std::unique_ptr<DeadLoad>> dead_loads;  ///< gravity, point and edge loads
  std::vector<std::unique_ptr<Pressure>> pressures;
  std::vector<std::unique_ptr<EndMoment>> end_moments;
  struct LaggedLoad {
    std::unique_ptr<DeadLoad> energy;
    /// Adds the nodal forces at these positions and velocities to the third argument.
    std::function<void(const Vector&, const Vector&, Vector&)> forces;
  };
  std::vector<LaggedLoad> lagged_loads;  ///< wind, pressure without a potential
  std::vector<std::unique_ptr<Constraint>> constraints;
  std::vector<std::unique_ptr<LinearEqualities>> equalities;  ///< couplings of fine membranes to their shells
  std::vector<PinnedVariable> pins;                           ///< ascending variables
  std::vector<std::vector<int>> probed;  ///< vertices of each of Scene::output.probes, or triangles of its body
  std::vector<std::string> notes;        ///< what a person should know before trusting the result, a line each
  /// Moves the obstacles to where they are at `time`; empty where none move.
  std::vector<std::function<void(double time)>> movers;

  /// Where not null the only body moves in these modes: `positions` and `velocities` are the reduced coordinates q and
  /// their rates, and energies and constraints are of them.
  std::shared_ptr<const ModalBasis> modal;
  std::vector<std::unique_ptr<Energy>> damped;  ///< of modes: what stiffness_damping borrows, no energies of the step
  std::vector<std::unique_ptr<WarpedLoad>> warped_loads;  ///< gravity and dead loads on modes
  /// Hold rotations at those of the predicted q; empty unless the scene asks for it.
  std::vector<std::function<void(const Vector& predicted)>> freezers;

  Model();
  Model(Model&&) noexcept;
  Model& operator=(Model&&) noexcept;
  ~Model();
  /// Positions of the vertices where the unknowns are x, 3 entries each, m.
  Vector vertex_positions(const Vector& x) const;
  /// Their velocities where the unknowns' rates are v, m/s.
  Vector vertex_velocities(const Vector& x, const Vector& v) const;
  /// Positions of the vertices at the start, m.
  Vector start() const { return vertex_positions(positions); }
};

}  // namespace taut
