#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/residuals.h"

namespace taut {

/// A number, where null is a NaN.
double number(const nlohmann::ordered_json& json);

/// The residuals as every file of Taut names them, without violations and `finite`.
nlohmann::ordered_json residuals_json(const Residuals& residuals);
/// What residuals_json() has written; the rest of the result is as made.
Residuals read_residuals(const nlohmann::ordered_json& json);

/// Counts with all their names.
Counts read_counts(const nlohmann::ordered_json& json);

}  // namespace taut
