#pragma once

#include <vector>

#include "dynamics/model.h"

namespace taut {

/// A body's middle surface: a vertex of its mesh is the mean of its bottom and top nodes.
struct MiddleSurface {
  TriangleMesh start;          ///< m; its vertices are the material points of the body
  std::vector<Vector3> moved;  ///< displacements of its vertices, m
};

/// Of a body where the scene's vertices are at `end` (3 entries each, m).
MiddleSurface middle_surface(const Model& model, const BodyRange& body, const Vector& end);

}  // namespace taut
