#include "study/solver_entries.h"

namespace taut {

const std::vector<SolverEntry>& solver_entries() {
  static const std::vector<SolverEntry> entries{
      {"augmented_lagrangian", "the default, as the problem has it", {}},
      {"multiplier_loop", "the augmented Lagrangian without the central path", {{"solver.central_path", "false"}}},
  };
  return entries;
}

const SolverEntry& solver_entry(const std::string& label) {
  std::string allowed;
  for (const SolverEntry& entry : solver_entries()) {
    if (entry.label == label) return entry;
    allowed += (allowed.empty() ? "" : ", ") + entry.label;
  }
  throw InputError("--solvers: found " + label + ", allowed: " + allowed);
}

}  // namespace taut
