#include "energies/wind.h"

#include <cmath>

namespace taut {

void add_wind(const Wind& wind, const std::vector<Triangle>& triangles, int first_vertex, const Vector& positions,
              const Vector& velocities, Vector& forces) {
  for (const Triangle& triangle : triangles) {
    Vector3 corner[3], velocity = Vector3::Zero();
    for (int j = 0; j < 3; ++j) {
      corner[j] = positions.segment<3>(3 * (triangle[j] + first_vertex));
      velocity += velocities.segment<3>(3 * (triangle[j] + first_vertex)) / 3;
    }
    const Vector3 area = 0.5 * (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double size = area.norm();
    if (!(size > 0)) continue;
    const Vector3 normal = area / size;
    const double speed = (wind.velocity - velocity).dot(normal);
    const Vector3 force = (0.5 * wind.air_density * wind.drag * size * std::abs(speed) * speed) * normal;
    for (int vertex : triangle) forces.segment<3>(3 * (vertex + first_vertex)) += force / 3;
  }
}

}  // namespace taut
