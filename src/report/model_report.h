#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "problems/scene.h"
#include "study/solve_model.h"

namespace taut {

/// For html_report.h: how a model was solved, its residuals, the rows and bounds furthest outside, and of large models
/// the first thousand variables and rows.
nlohmann::json model_report(const NlModel& model, const ModelSolution& solution, const Scene& settings,
                            const std::string& command);

}  // namespace taut
