#include "geometry/crossing.h"

namespace taut {

#ifndef TAUT_WITH_CGAL
std::optional<Crossing> find_crossing(const std::vector<Vector3>& /*points*/,
                                      const std::vector<Triangle>& /*triangles*/) {
  return std::nullopt;
}
#endif

}  // namespace taut
