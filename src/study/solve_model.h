#pragma once

#include <filesystem>
#include <string>

#include "core/solver.h"
#include "problems/nl_model.h"
#include "problems/scene.h"
#include "study/records.h"

namespace taut {

/// What came of a model. `x` and `dual` (NlProblem::dual) are there whatever the status.
struct ModelSolution {
  RunSummary summary;          ///< of one step
  bool false_success = false;  ///< the solver, or the library behind it, says solved, the residuals do not
  Vector x, dual;
};

/// Solves a model with the settings of read_model_settings() and judges the result by core/residuals.h, whatever the
/// solver says. `version` is that of the calling program. Throws InputError for a model that has no problem.
ModelSolution solve_model(const NlModel& model, const Scene& settings, const Budget& budget,
                          const std::string& version);

/// summary.json, and solution.json: the variables, and the rows' values and multipliers, by name. The folder is made
/// where it is missing. Throws FileError.
void write_model_solution(const std::filesystem::path& folder, const NlModel& model, ModelSolution& solution);

}  // namespace taut
