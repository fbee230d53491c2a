#include "study/export_step.h"

#include "problems/nl_step.h"
#include "study/examine.h"

namespace taut {

NlFile export_step(const Scene& scene, const Model& model, Stepper& stepper) {
  const Problem& problem = stepper.prepare();
  std::vector<std::string> names;
  for (Index i = 0; i < problem.size(); ++i) names.push_back(vertex_name(model, i / 3) + ", " + "xyz"[i % 3]);
  return step_as_nl(problem, stepper.state().warm, std::move(names), scene.source);
}

}  // namespace taut
