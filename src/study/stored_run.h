#pragma once

#include <filesystem>
#include <vector>

#include "problems/scene.h"
#include "study/records.h"
#include "study/run_folder.h"

namespace taut {

/// A run as it is on disk.
struct StoredRun {
  Scene scene;
  Continuation checkpoint;
  RunSummary summary;
  std::vector<StepRecord> steps;
};

/// Reads what `taut solve --out` has written, but for frames and pictures. Throws RunRefused where there is no run,
/// FileError or InputError where a file is damaged or does not fit the others.
StoredRun read_stored_run(const std::filesystem::path& folder);

}  // namespace taut
