#pragma once

#include <string>

#include "study/records.h"

namespace taut {

/// A run in about ten lines for a person: verdict, worst residuals and violations and where, seconds. `folder` is where
/// its files are; empty: nowhere.
std::string terminal_summary(const RunSummary& summary, const std::string& folder);

}  // namespace taut
