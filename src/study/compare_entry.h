#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"
#include "study/compare_job.h"
#include "study/compare_records.h"

namespace taut {

/// How an entry's process is started.
struct EntryProcess {
  std::vector<std::string> worker;  ///< command; the job's file is appended
  bool resume = false;              ///< take over what an earlier process with the same job has finished
  const std::atomic<bool>* stop = nullptr;
};

/// Carries out the job in a process of its own, in `folder`, and takes what it has left into `run`: the steps, the
/// outcome, seconds and memory. The folder is emptied first, and so is that of the states where the job records them.
/// A process that was interrupted is not finished and is not taken over. Throws FileError.
void run_entry(const std::filesystem::path& folder, const CompareJob& job, const EntryProcess& process, EntryRun& run);

/// The positions that the entry in `folder` has reached in a step, m. Throws FileError.
Vector read_positions(const std::filesystem::path& folder, int step);

}  // namespace taut
