#include "study/state_arrays.h"

namespace taut {
namespace {

std::vector<double> array(const Vector& vector) { return {vector.begin(), vector.end()}; }

void put_multipliers(const std::vector<Vector>& multipliers, NamedArrays& arrays) {
  for (std::size_t k = 0; k < multipliers.size(); ++k) {
    arrays["multipliers " + std::to_string(k)] = array(multipliers[k]);
  }
}

}  // namespace

NamedArrays state_arrays(const State& state) {
  // A structured binding, so that a member that State gains cannot be forgotten here.
  const auto& [step, positions, velocities, accelerations, previous_positions, previous_velocities,
               auxiliary_accelerations, warm] = state;
  NamedArrays arrays{{"positions", array(positions)},
                     {"velocities", array(velocities)},
                     {"accelerations", array(accelerations)},
                     {"previous_positions", array(previous_positions)},
                     {"previous_velocities", array(previous_velocities)},
                     {"auxiliary_accelerations", array(auxiliary_accelerations)},
                     {"penalties", warm.penalties},
                     {"force_scale", {warm.force_scale}},
                     {"changes", warm.changes}};
  put_multipliers(warm.multipliers, arrays);
  return arrays;
}

State state_from(int step, const NamedArrays& arrays) {
  State state{step,
              vector_of(arrays, "positions"),
              vector_of(arrays, "velocities"),
              vector_of(arrays, "accelerations"),
              vector_of(arrays, "previous_positions"),
              vector_of(arrays, "previous_velocities"),
              vector_of(arrays, "auxiliary_accelerations"),
              {{}, arrays.at("penalties"), arrays.at("force_scale").at(0), arrays.at("changes")}};
  for (std::size_t k = 0;; ++k) {
    const std::string name = "multipliers " + std::to_string(k);
    if (!arrays.contains(name)) return state;
    state.warm.multipliers.push_back(vector_of(arrays, name));
  }
}

NamedArrays solution_arrays(const Result& result, const Model& model) {
  NamedArrays arrays{{"positions", array(model.vertex_positions(result.x))}};
  put_multipliers(result.multipliers, arrays);
  return arrays;
}

Vector vector_of(const NamedArrays& arrays, const std::string& name) {
  const std::vector<double>& array = arrays.at(name);
  return Eigen::Map<const Vector>(array.data(), static_cast<Index>(array.size()));
}

}  // namespace taut
