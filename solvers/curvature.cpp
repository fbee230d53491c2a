#include "solvers/curvature.h"

#include <deque>

#include "solvers/eliminated_slack.h"
#include "solvers/equality_system.h"

namespace taut {

std::optional<Index> negative_curvatures(const Problem& problem, const Result& result,
                                         const std::vector<double>& penalties) {
  std::deque<EliminatedSlack> slacks;
  std::vector<const Energy*> terms = problem.energies;
  for (std::size_t k = 0; k < problem.constraints.size(); ++k) {
    EliminatedSlack& slack = slacks.emplace_back(*problem.constraints[k]);
    slack.set_multipliers(result.multipliers[k]);
    if (k < penalties.size() && penalties[k] > 0) slack.set_penalty(penalties[k]);
    terms.push_back(&slack);
  }
  const EqualityRows equalities(problem);
  Assembly assembly(problem.size(), terms, problem.fixed_variables, 1);
  QuasiDefiniteSystem system(assembly, equalities, problem.fixed_variables);
  assembly.hessian(result.x, Curvature::exact);
  system.factorize(0);
  return system.negative_curvatures();
}

}  // namespace taut
