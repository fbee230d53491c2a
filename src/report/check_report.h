#pragma once

#include <string>

#include "study/check.h"

namespace taut {

/// A check for a person: verdict, what was found, the worst of each constraint and, where it says something, the frames
/// with the worst first.
std::string check_table(const CheckReport& report);

/// check.json: everything in the report. Numbers that are not finite are null.
std::string check_json(const CheckReport& report);

/// check.csv: a line for each frame and constraint, with a header.
std::string check_csv(const CheckReport& report);

}  // namespace taut
