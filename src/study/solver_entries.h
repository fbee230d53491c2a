#pragma once

#include <string>
#include <vector>

#include "problems/read_scene.h"

namespace taut {

/// A label of `taut compare --solvers`, and what of the problem it replaces.
struct SolverEntry {
  std::string label, description;
  Overrides overrides;
};

/// Every label there is.
const std::vector<SolverEntry>& solver_entries();

/// The entry of that label. Throws InputError with the `option` that names it and the labels that are allowed.
const SolverEntry& solver_entry(const std::string& label, const std::string& option = "--solvers");

}  // namespace taut
