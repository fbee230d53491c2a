#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "problems/read_scene.h"
#include "study/child_process.h"

namespace taut {

/// What one worker process of a comparison has to do. It works in the folder of its job file.
struct CompareJob {
  std::string problem;  ///< file, absolute
  Overrides overrides;
  std::string states;    ///< folder of the states, relative to the job's; empty: follow the own trajectory
  bool records = false;  ///< follow the own trajectory, write its states to `states`, end at the first step not solved
  bool cold = false;     ///< no multipliers and penalties from the states
  bool untimed = false;  ///< no solve ahead of the first step, and the first step not solved is the last
  int steps = 1;         ///< 0: those of the problem
  int repeat = 1, threads = 1;
  double seconds = 0;             ///< wall clock; 0: no limit
  std::int64_t memory_bytes = 0;  ///< 0: no limit
  std::string scene_hash,
      trajectory_hash;  ///< of the scene (empty: any), and of that whose trajectory gives the states
  std::string version;  ///< of the program
};

/// The text of a job file. Two jobs with the same text have the same result but for the seconds.
std::string job_text(const CompareJob& job);
/// What job_text() has written. Throws std::runtime_error for anything else.
CompareJob parse_job(const std::string& text);

/// The file of a step's state or solution in a folder.
std::filesystem::path step_file(const std::filesystem::path& folder, int step);

// Files in the folder of a job.
inline constexpr const char* job_file = "job.json";
inline constexpr const char* trials_file = "steps.jsonl";     // a line per step
inline constexpr const char* solutions_folder = "solutions";  // positions and multipliers, a checkpoint per step
inline constexpr const char* log_file = "log.txt";
inline constexpr const char* outcome_file = "run.json";  // written last, by the parent

/// How a worker process ends.
enum WorkerExit {
  worker_finished = 0,
  worker_failed = 1,
  worker_refused = 2,  ///< the problem cannot be read or built
  worker_out_of_time = 3,
  worker_out_of_memory = 4
};

/// EntryRun::outcome of a worker process.
std::string outcome_of(const ChildOutcome& child);

/// Carries out the job of a job file, in this process. Returns a WorkerExit; why it failed goes to standard error.
int work(const std::filesystem::path& job);

}  // namespace taut
