#include "study/solver_entries.h"

namespace taut {

const std::vector<SolverEntry>& solver_entries() {
  static const std::vector<SolverEntry> entries{
      {"augmented_lagrangian",
       "the default solver, as the problem has its options",
       {{"solver.method", "augmented_lagrangian"}}},
      {"multiplier_loop",
       "the same without the central path",
       {{"solver.method", "augmented_lagrangian"}, {"solver.central_path", "false"}}},
      {"fixed_penalty",
       "the published method: one penalty of 1e3 N/m, multipliers from zero in each step, no central path",
       {{"solver.method", "augmented_lagrangian"},
        {"solver.central_path", "false"},
        {"solver.fixed_penalty", "1000"},
        {"solver.warm_multipliers", "false"}}},
      {"penalised_pins",
       "the default solver with pins as penalised rows",
       {{"solver.method", "augmented_lagrangian"}, {"solver.pins", "penalised"}}},
      {"penalised_equalities",
       "the default solver with couplings of covers as penalised rows",
       {{"solver.method", "augmented_lagrangian"}, {"solver.equalities", "penalised"}}},
      {"null_space",
       "pins and couplings in the null space of their equations, another factorisation",
       {{"solver.method", "null_space"}}},
      {"null_space_cg",
       "the same by conjugate gradients, without a factor",
       {{"solver.method", "null_space"}, {"solver.null_space", "conjugate_gradients"}}},
      {"alternating",
       "a cover and its shell in turn, with a penalty and multipliers; up to 10000 rounds of both",
       {{"solver.method", "alternating"}, {"solver.max_outer", "10000"}}},
      {"ipopt", "interior point, by Ipopt", {{"solver.method", "ipopt"}}},
      {"nlopt", "sequential quadratic programming, by NLopt; small problems only", {{"solver.method", "nlopt"}}},
      {"nlopt_lbfgs",
       "NLopt's augmented Lagrangian over its limited-memory BFGS; small problems only",
       {{"solver.method", "nlopt"}, {"solver.nlopt.algorithm", "auglag_lbfgs"}}},
  };
  return entries;
}

const SolverEntry& solver_entry(const std::string& label, const std::string& option) {
  std::string allowed;
  for (const SolverEntry& entry : solver_entries()) {
    if (entry.label == label) return entry;
    allowed += (allowed.empty() ? "" : ", ") + entry.label;
  }
  throw InputError(option + ": found " + label + ", allowed: " + allowed);
}

}  // namespace taut
