#pragma once

#include <string>

#include "study/solve_model.h"

namespace taut {

/// What came of a model in about ten lines for a person. `folder` is where its files are; empty: nowhere.
std::string model_summary(const ModelSolution& solution, const std::string& folder);

}  // namespace taut
