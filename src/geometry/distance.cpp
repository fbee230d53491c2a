#include "geometry/distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace taut {

SegmentDistance point_segment_distance(const Vector3& point, const Vector3& a, const Vector3& b) {
  const Vector3 direction = b - a;
  const double length_squared = direction.squaredNorm();
  const double parameter = length_squared > 0 ? std::clamp((point - a).dot(direction) / length_squared, 0.0, 1.0) : 0.0;
  const Vector3 nearest = a + parameter * direction;
  return {(point - nearest).norm(), parameter, nearest};
}

TriangleDistance point_triangle_distance(const Vector3& point, const Vector3& a, const Vector3& b, const Vector3& c) {
  // Where the foot of the perpendicular is inside, it is the answer; otherwise the answer lies on an edge.
  const Vector3 normal = (b - a).cross(c - a);
  const double normal_squared = normal.squaredNorm();
  if (normal_squared > 0) {
    const double at_b = (point - a).cross(c - a).dot(normal) / normal_squared;
    const double at_c = (b - a).cross(point - a).dot(normal) / normal_squared;
    const Vector3 weights(1 - at_b - at_c, at_b, at_c);
    if (weights.minCoeff() >= 0) {
      const Vector3 nearest = weights[0] * a + weights[1] * b + weights[2] * c;
      return {(point - nearest).norm(), weights, nearest};
    }
  }
  const std::array<const Vector3*, 3> corners{&a, &b, &c};
  TriangleDistance best{};
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const SegmentDistance edge = point_segment_distance(point, *corners[k], *corners[next]);
    if (k > 0 && edge.distance >= best.distance) continue;
    best = {edge.distance, Vector3::Zero(), edge.nearest};
    best.weights[k] = 1 - edge.parameter;
    best.weights[next] = edge.parameter;
  }
  return best;
}

}  // namespace taut
