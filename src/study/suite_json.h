#pragma once

#include <string>
#include <string_view>

#include "study/suite.h"

namespace taut {

/// One line, without the line break.
std::string suite_run_line(const SuiteRun& run);
/// What suite_run_line() has written. Throws std::runtime_error for anything else.
SuiteRun parse_suite_run(std::string_view line);

}  // namespace taut
