#pragma once

#include <string>
#include <string_view>

#include "study/records.h"

namespace taut {

// Doubles are written with as many digits as give them back; NaNs and infinities become null, which reads as NaN.

/// The text of summary.json.
std::string summary_text(const RunSummary& summary);
/// What summary_text() has written. Throws std::runtime_error for anything else.
RunSummary parse_summary(std::string_view text);

/// One line of steps.jsonl, without the line break. Only its "seconds" differ from run to run.
std::string step_line(const StepRecord& record);
/// What step_line() has written; Violation::element is not in it. Throws std::runtime_error for anything else.
StepRecord parse_step(std::string_view line);

}  // namespace taut
