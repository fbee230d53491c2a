#pragma once

#include "study/lean_errors.h"
#include "study/lean_runs.h"

namespace taut {

/// Tries each omission of a ladder, and then together those that change little enough, on the model with these levels,
/// which leaves nothing out. Returns them with what may be left out; outcome.omissions tells what became of each.
Levels screen_omissions(const LeanLadder& ladder, const Levels& levels, LeanRuns& runs, LeanErrors& errors,
                        LeanOutcome& outcome);

}  // namespace taut
