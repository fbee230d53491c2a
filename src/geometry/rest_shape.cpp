#include "geometry/rest_shape.h"

#include <stdexcept>
#include <string>

namespace taut {
namespace {

RestTriangle rest_triangle(const Triangle& vertices, int first_vertex, const Matrix2& edges, std::size_t index) {
  RestTriangle rest;
  for (int j = 0; j < 3; ++j) rest.vertices[j] = vertices[j] + first_vertex;
  const double determinant = edges.determinant();
  rest.area = 0.5 * std::abs(determinant);
  if (!(rest.area > 0))
    throw std::invalid_argument("rest_triangles: triangle " + std::to_string(index) + " has no rest area");
  TriangleShape a;
  a << -1, -1, 1, 0, 0, 1;
  rest.shape = a * edges.inverse();
  return rest;
}

}  // namespace

std::vector<RestTriangle> rest_triangles(const std::vector<Triangle>& triangles,
                                         const std::vector<Vector3>& rest_positions, int first_vertex) {
  std::vector<RestTriangle> rest;
  rest.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vector3 e1 = rest_positions.at(triangles[t][1]) - rest_positions.at(triangles[t][0]);
    const Vector3 e2 = rest_positions.at(triangles[t][2]) - rest_positions.at(triangles[t][0]);
    const Vector3 axis = e1.normalized();
    Matrix2 edges;
    edges << e1.norm(), axis.dot(e2), 0, (e2 - axis.dot(e2) * axis).norm();
    rest.push_back(rest_triangle(triangles[t], first_vertex, edges, t));
  }
  return rest;
}

std::vector<RestQuad> rest_quads(const std::vector<RestTriangle>& triangles) {
  const auto count = static_cast<Index>(triangles.size());
  std::vector<RestQuad> packed(static_cast<std::size_t>(quads(count)));
  for (Index quad = 0; quad < quads(count); ++quad) {
    const auto triangle = [&](int lane) -> const RestTriangle& { return triangles[element_of(quad, lane, count)]; };
    RestQuad& four = packed[quad];
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 2; ++k) four.shape[j][k] = lanes_of([&](int lane) { return triangle(lane).shape(j, k); });
    }
    four.area = lanes_of([&](int lane) { return triangle(lane).area; });
  }
  return packed;
}

std::vector<RestTriangle> rest_triangles(const std::vector<Triangle>& triangles,
                                         const std::vector<std::array<Vector2, 3>>& corners, int first_vertex) {
  if (corners.size() != triangles.size()) {
    throw std::invalid_argument("rest_triangles: " + std::to_string(corners.size()) + " corner triples, expected " +
                                std::to_string(triangles.size()));
  }
  std::vector<RestTriangle> rest;
  rest.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Matrix2 edges;
    edges << corners[t][1] - corners[t][0], corners[t][2] - corners[t][0];
    rest.push_back(rest_triangle(triangles[t], first_vertex, edges, t));
  }
  return rest;
}

}  // namespace taut
