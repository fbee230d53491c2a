#pragma once

#include <string>
#include <string_view>

#include "study/compare_records.h"

namespace taut {

// As in records_json.h, NaNs and infinities become null, which reads as NaN.

/// One line of an entry's steps.jsonl, without the line break and without positions, multipliers and distance.
std::string trial_line(const StepTrial& trial);
/// What trial_line() has written. Throws std::runtime_error for anything else.
StepTrial parse_trial(std::string_view line);

/// compare.json: everything but positions and multipliers.
std::string comparison_text(const Comparison& comparison);

}  // namespace taut
