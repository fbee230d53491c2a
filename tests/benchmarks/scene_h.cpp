#include "benchmarks/scene_h.h"

#include <random>
#include <variant>

#include "problems/read_scene.h"

namespace taut::benchmarks {

Scene scene_h(int cells, const Limit& limit, const std::string& membrane_law) {
  const std::string side = std::to_string(cells);
  Scene scene = read_scene(
      TAUT_CATALOGUE "/hanging_cloth.json",
      {{"bodies.cloth.mesh.grid.cells", "[" + side + ", " + side + "]"}, {"bodies.cloth.membrane.law", membrane_law}});
  if (!limit.min && !limit.max) {
    std::erase_if(scene.constraints, [](const scene::Constraint& constraint) { return constraint.name == "limit"; });
  }
  for (scene::Constraint& constraint : scene.constraints) {
    if (auto* strain = std::get_if<scene::StrainLimit>(&constraint.kind)) {
      strain->min = limit.min;
      strain->max = limit.max;
    }
  }
  return scene;
}

Vector crumpled(const Model& model, int cells, double fraction) {
  // The engine's numbers are prescribed by the standard, those of its distributions are not.
  std::mt19937 engine(1);
  Vector x = model.positions;
  for (double& coordinate : x)
    coordinate += fraction / cells * (2.0 * static_cast<double>(engine()) / std::mt19937::max() - 1);
  return x;
}

}  // namespace taut::benchmarks
