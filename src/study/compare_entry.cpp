#include "study/compare_entry.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "files/checkpoint.h"
#include "study/child_process.h"
#include "study/compare_json.h"
#include "study/state_arrays.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// The worker keeps to its time by itself; this much later it is ended.
constexpr double patience = 1;  // s

void take_outcome(const ChildOutcome& child, const fs::path& folder, EntryRun& run) {
  run.seconds = child.seconds;
  run.peak_memory_bytes = child.peak_memory_bytes;
  run.message = last_line(folder / log_file);
  run.outcome = outcome_of(child);
}

/// The steps that the process has finished, a half-written line left out.
void read_trials(const fs::path& folder, EntryRun& run) {
  run.trials.clear();
  if (!fs::exists(folder / trials_file)) return;
  const std::string text = read_bytes(folder / trials_file);
  std::size_t begin = 0;
  for (std::size_t end = text.find('\n'); end != text.npos; end = text.find('\n', begin)) {
    run.trials.push_back(parse_trial(std::string_view(text).substr(begin, end - begin)));
    begin = end + 1;
  }
  // What the process says of itself leaves out the memory of this one, which the system counts before exec.
  if (run.outcome == "finished" && !run.trials.empty()) run.peak_memory_bytes = run.trials.back().peak_memory_bytes;
}

void write_outcome(const fs::path& folder, const EntryRun& run) {
  const Json json{{"outcome", run.outcome},
                  {"message", run.message},
                  {"seconds", run.seconds},
                  {"peak_memory_bytes", run.peak_memory_bytes}};
  write_atomically(folder / outcome_file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// False where the folder has no finished process with this job.
bool take_over(const fs::path& folder, const CompareJob& job, EntryRun& run) try {
  if (read_bytes(folder / job_file) != job_text(job)) return false;
  const Json json = Json::parse(read_bytes(folder / outcome_file));
  run.outcome = json.at("outcome");
  run.message = json.at("message");
  run.seconds = json.at("seconds");
  run.peak_memory_bytes = json.at("peak_memory_bytes");
  read_trials(folder, run);
  run.resumed = true;
  return true;
} catch (const std::exception&) {
  return false;
}

}  // namespace

void run_entry(const fs::path& folder, const CompareJob& job, const EntryProcess& process, EntryRun& run) {
  if (process.resume && take_over(folder, job, run)) return;
  fs::remove_all(folder);
  fs::create_directories(folder);
  if (job.records) {
    fs::remove_all(folder / job.states);
    fs::create_directories(folder / job.states);
  }
  write_atomically(folder / job_file, job_text(job));
  std::vector<std::string> command = process.worker;
  command.push_back((folder / job_file).string());
  const ChildLimits limits{.seconds = job.seconds > 0 ? job.seconds + patience : 0, .memory_bytes = job.memory_bytes};
  const ChildOutcome child = run_child(command, folder / log_file, limits, process.stop);
  take_outcome(child, folder, run);
  read_trials(folder, run);
  if (run.outcome != "interrupted") write_outcome(folder, run);
}

Vector read_positions(const fs::path& folder, int step) {
  return vector_of(read_checkpoint(step_file(folder / solutions_folder, step)).arrays, "positions");
}

}  // namespace taut
