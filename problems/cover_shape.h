#pragma once

#include "problems/body_shape.h"

namespace taut {

/// The surface of a shell that a cover is on, as a mesh at the start; edges and corners of a grid are groups.
TriangleMesh carrying_surface(const BodyShape& shell, scene::Surface surface);

/// Random displacements along the normals of the points, at most `amplitude`, without the part that the coarse mesh
/// would follow; m.
std::vector<Vector3> imperfection(const TriangleMesh& mesh, const Prolongation& prolongation, double amplitude,
                                  unsigned seed);

}  // namespace taut
