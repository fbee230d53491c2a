#pragma once

#include "core/types.h"

namespace taut {

/// The point of a segment that is nearest to another point.
struct SegmentDistance {
  double distance;   ///< m
  double parameter;  ///< 0 at the first end, 1 at the second
  Vector3 nearest;
};

/// The point of a triangle that is nearest to another point.
struct TriangleDistance {
  double distance;  ///< m
  Vector3 weights;  ///< barycentric: nearest = weights[0] a + weights[1] b + weights[2] c, none negative
  Vector3 nearest;
};

/// Distance of `point` from the segment a, b; one of zero length counts as the point a.
SegmentDistance point_segment_distance(const Vector3& point, const Vector3& a, const Vector3& b);

/// Distance of `point` from the triangle a, b, c, interior included; one of zero area counts as its three edges.
TriangleDistance point_triangle_distance(const Vector3& point, const Vector3& a, const Vector3& b, const Vector3& c);

}  // namespace taut
