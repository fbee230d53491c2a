#include "geometry/prism.h"

#include <algorithm>
#include <limits>

namespace taut {

PrismShape::PrismShape(const std::array<Vector3, 6>& points) {
  for (int j = 0; j < 3; ++j) {
    mid.col(j) = 0.5 * (points[2 * j] + points[2 * j + 1]);
    director.col(j) = 0.5 * (points[2 * j + 1] - points[2 * j]);
  }
}

PrismJacobian::PrismJacobian(const PrismShape& shape) {
  const Vector3 x12 = shape.mid.col(1) - shape.mid.col(0), x13 = shape.mid.col(2) - shape.mid.col(0);
  const Vector3 n12 = shape.director.col(1) - shape.director.col(0),
                n13 = shape.director.col(2) - shape.director.col(0);
  g = shape.director.transpose() * x12.cross(x13);
  h = shape.director.transpose() * (x12.cross(n13) + n12.cross(x13));
  i = shape.director.determinant();
}

double PrismJacobian::smallest(int* corner) const {
  double lowest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    double value = std::min(g[k] - h[k], g[k] + h[k]) + i;
    // A parabola that opens upwards may be lowest inside.
    if (i > 0 && std::abs(h[k]) < 2 * i) value = std::min(value, g[k] - h[k] * h[k] / (4 * i));
    if (!(value >= lowest)) {
      lowest = value;
      if (corner) *corner = k;
    }
  }
  return lowest;
}

}  // namespace taut
