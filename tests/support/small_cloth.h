#pragma once

#include <memory>
#include <string>
#include <vector>

#include "constraints/obstacle.h"
#include "constraints/strain_limit.h"
#include "core/solver.h"
#include "energies/dead_load.h"
#include "energies/membrane.h"
#include "support/meshes.h"
#include "support/problems.h"

namespace taut {

/// Steps of implicit Euler of a cloth of 4 x 4 cells held at two corners under gravity, with one kind of constraint
/// that it meets within a few steps.
struct SmallCloth {
  static constexpr int cells = 4;
  static constexpr double step = 0.03;
  TriangleMesh mesh = make_grid(1, 1, cells, cells, Diagonals::alternating);
  std::vector<RestTriangle> triangles = rest_triangles(mesh.triangles, mesh.vertices);
  std::shared_ptr<Inertia> inertia =
      std::make_shared<Inertia>(Inertia::lumped("inertia", triangles, 0.15, static_cast<Index>(mesh.vertices.size())));
  OwnedProblem owned;
  Vector velocity;

  explicit SmallCloth(std::shared_ptr<const Constraint> constraint) {
    Problem& problem = owned.problem;
    problem.initial_guess = flatten(mesh.vertices);
    velocity = Vector::Zero(problem.size());
    owned.pin({cells * (cells + 1), cells * (cells + 1) + cells});
    Vector fall = Vector::Zero(problem.size()), weight = fall;
    for (Index i = 2; i < problem.size(); i += 3) fall[i] = -9.81;
    inertia->add_product(fall, weight);
    inertia->set_target(1 / (step * step), problem.initial_guess);
    owned.add(std::shared_ptr<const Energy>(inertia));
    owned.add(std::make_shared<DeadLoad>("gravity", weight));
    owned.add(std::make_shared<Membrane>("membrane", triangles, MembraneLaw::stvk, Lame::plane_stress(8210, 0.243),
                                         0.318e-3));
    owned.add(std::move(constraint));
    problem.topology = new_topology();
  }

  /// Poses the step that follows `x`.
  void accept(const Vector& x) {
    velocity = (x - owned.problem.initial_guess) / step;
    owned.problem.initial_guess = x;
    inertia->set_target(1 / (step * step), x + step * velocity);
  }
};

/// What a SmallCloth may meet, by name.
inline std::shared_ptr<const Constraint> small_cloth_constraint(const std::string& kind) {
  const TriangleMesh mesh = make_grid(1, 1, SmallCloth::cells, SmallCloth::cells, Diagonals::alternating);
  const auto triangles = rest_triangles(mesh.triangles, mesh.vertices);
  std::vector<int> vertices;
  for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v) vertices.push_back(v);
  if (kind == "matrix_limit") return std::make_shared<MatrixStrainLimit>(limit_on(triangles, 0.9, 1.1));
  if (kind == "inextensible") return std::make_shared<MatrixStrainLimit>(limit_on(triangles, 1, 1));
  if (kind == "upper_matrix_limit") return std::make_shared<MatrixStrainLimit>(limit_on(triangles, 0, 1.02));
  if (kind == "singular_value_limit") return std::make_shared<SingularValueStrainLimit>(limit_on(triangles, 0.9, 1.1));
  if (kind == "half_space") {
    auto floor = std::make_shared<HalfSpace>("floor", "cloth", vertices, 0, 1.0);
    floor->place({0, 0, -0.1}, {0, 0.1, 1});
    return floor;
  }
  auto ball = std::make_shared<SphereObstacle>("ball", "cloth", vertices, 0, 1.0, 0.3);
  ball->place({0.5, 0.3, -0.35});
  return ball;
}

}  // namespace taut
