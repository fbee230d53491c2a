#pragma once

#include <vector>

#include "geometry/triangle_mesh.h"

namespace taut {

/// Area of the triangle a, b, c, m^2.
double triangle_area(const Vector3& a, const Vector3& b, const Vector3& c);

/// Area of every triangle, m^2.
std::vector<double> triangle_areas(const TriangleMesh& mesh);

/// Length of the diagonal of the axis-aligned box around all vertices, m; 0 for a mesh without vertices.
double bounding_box_diagonal(const TriangleMesh& mesh);

/// Mean length of the edges, each counted once, m. Throws std::invalid_argument for a mesh without triangles.
double mean_edge_length(const TriangleMesh& mesh);

}  // namespace taut
