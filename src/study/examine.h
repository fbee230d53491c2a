#pragma once

#include <string>
#include <vector>

#include "core/problem.h"
#include "dynamics/model.h"
#include "study/records.h"

namespace taut {

/// The sum of the problem's energies at x, J.
double objective(const Problem& problem, const Vector& x);

/// residuals() with names for people: "vertex 3 of cloth" for a node, and another name for the pins where a constraint
/// is called "pins". `problem` is a step of `model`.
Residuals named_residuals(const Model& model, const Problem& problem, const Result& result);

/// The name under which residuals speak of the pins of this model.
std::string pins_name(const Model& model);

/// How deep the edges and faces between the vertices of each sphere obstacle are inside it, at x and where the spheres
/// are now.
std::vector<Penetration> penetrations(const Model& model, const Vector& x);

/// The at most `count` elements that are furthest outside, each relative to its constraint's violation_scale(); none
/// that is inside.
std::vector<WorstElement> worst_elements(const Problem& problem, const Vector& x, int count);

/// "vertex 3 of cloth" for a vertex of the scene.
std::string vertex_name(const Model& model, Index vertex);

/// "triangle 17 of cloth" for a triangle of the scene.
std::string triangle_name(const Model& model, Index triangle);

}  // namespace taut
