#include "study/middle_surface.h"

namespace taut {

MiddleSurface middle_surface(const Model& model, const BodyRange& body, const Vector& end) {
  const Vector start = model.start();
  const auto middle = [&](const Vector& x, int vertex) {
    const int bottom = body.first_vertex + vertex * body.levels, top = bottom + body.levels - 1;
    return Vector3((x.segment<3>(3 * bottom) + x.segment<3>(3 * top)) / 2);
  };
  MiddleSurface surface;
  for (int vertex = 0; vertex < body.vertices / body.levels; ++vertex) {
    surface.start.vertices.push_back(middle(start, vertex));
    surface.moved.push_back(middle(end, vertex) - surface.start.vertices.back());
  }
  const int triangles = body.levels > 1 ? body.triangles / 2 : body.triangles;
  for (int t = body.first_triangle; t < body.first_triangle + triangles; ++t) {
    Triangle triangle = model.triangles[static_cast<std::size_t>(t)];
    for (int& vertex : triangle) vertex = (vertex - body.first_vertex) / body.levels;
    surface.start.triangles.push_back(triangle);
  }
  return surface;
}

}  // namespace taut
