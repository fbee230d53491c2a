#pragma once

#include <string>
#include <vector>

#include "core/problem.h"
#include "core/residuals.h"
#include "dynamics/model.h"
#include "study/records.h"

namespace taut {

/// The sum of the problem's energies at x, J.
double objective(const Problem& problem, const Vector& x);

/// The name under which residuals speak of the pins of this model.
std::string pins_name(const Model& model);

/// How deep the edges and faces between the vertices of each sphere obstacle are inside it, at x and where the spheres
/// are now.
std::vector<Penetration> penetrations(const Model& model, const Vector& x);

/// The at most `count` elements that are furthest outside, each relative to its constraint's violation_scale(); none
/// that is inside.
std::vector<WorstElement> worst_elements(const Problem& problem, const Vector& x, int count);

/// "vertex 3 of cloth" for a vertex of the scene, "vertex 3 (level 1) of plate" in a thick shell (level 0: bottom).
std::string vertex_name(const Model& model, Index vertex);

/// "triangle 17 of cloth" for a triangle of the scene.
std::string triangle_name(const Model& model, Index triangle);

/// The judge speaks of scene vertices and of "pins"; people know bodies, and may have called a constraint so.
void name_for_people(Residuals& residuals, const Problem& problem, const Model& model);

}  // namespace taut
