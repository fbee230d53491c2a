#pragma once

#include <vector>

#include "geometry/triangle_mesh.h"

namespace taut {

/// Aerodynamic drag normal to each triangle: force = 1/2 rho_air c_d A |u.n| (u.n) n with u the wind relative to the
/// triangle's mean velocity, a third on each vertex. It has no potential, so a step evaluates it at its start and holds
/// it (lagged; first order in the step).
struct Wind {
  Vector3 velocity = Vector3::Zero();  ///< m/s
  double air_density = 1.225;          ///< kg/m^3
  double drag = 1.0;                   ///< c_d, dimensionless
};

/// Adds the wind's nodal forces (N) at these positions and velocities (3 entries a vertex) to `forces`; `first_vertex`
/// is added to the indices.
void add_wind(const Wind& wind, const std::vector<Triangle>& triangles, int first_vertex, const Vector& positions,
              const Vector& velocities, Vector& forces);

}  // namespace taut
