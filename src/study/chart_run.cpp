#include "study/chart_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "study/child_process.h"
#include "study/stored_run.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr double patience = 5;                        // s; `taut solve` keeps to its time by itself
constexpr const char* outcome_file = "outcome.json";  // written last
constexpr const char* log_file = "log.txt";           // beside the run's folder, which takes nothing else

std::string outcome_of(const ChildOutcome& child, const std::string& last_words) {
  constexpr int solved = 0, not_solved = 3, interrupted = 130;
  switch (child.end) {
    case ChildEnd::interrupted:
      return "interrupted";
    case ChildEnd::time_limit:
      return "time_limit";
    case ChildEnd::memory_limit:
      return "out_of_memory";
    case ChildEnd::crashed:
      return "crash: " + signal_name(child.signal);
    case ChildEnd::exited:
      break;
  }
  if (child.code == solved || child.code == not_solved) return "finished";
  if (child.code == interrupted) return "interrupted";
  return last_words.find("out of memory") == last_words.npos ? "error" : "out_of_memory";
}

void write_outcome(const fs::path& file, const ChartPoint& point, const std::string& version) {
  const Json json{{"command", point.command}, {"version", version},
                  {"outcome", point.outcome}, {"message", point.message},
                  {"seconds", point.seconds}, {"peak_memory_bytes", point.peak_memory_bytes}};
  write_atomically(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// False where the folder has no finished run of this command.
bool take_over(const fs::path& file, const std::string& version, ChartPoint& point) try {
  const Json json = Json::parse(read_bytes(file));
  if (json.at("command") != Json(point.command) || json.at("version") != version) return false;
  point.outcome = json.at("outcome");
  point.message = json.at("message");
  point.seconds = json.at("seconds");
  point.peak_memory_bytes = json.at("peak_memory_bytes");
  point.resumed = true;
  return true;
} catch (const std::exception&) {
  return false;
}

/// What the run says of itself, where it came to say something.
void take_run(const fs::path& folder, ChartPoint& point) try {
  point.status = point.outcome;
  if (!fs::exists(folder / "summary.json")) return;
  const StoredRun run = read_stored_run(folder);
  const RunSummary& s = run.summary;
  point.steps_asked = s.steps_asked;
  point.steps_done = s.steps_done;
  point.steps_solved = s.steps_solved;
  point.counts = s.counts;
  point.seconds = s.seconds.total;
  point.solver_seconds = s.seconds.solver.total;
  point.peak_memory_bytes = s.peak_memory_bytes;
  point.violation = s.feasibility.scaled;
  point.probes.clear();
  for (const ProbeValue& probe : s.probes) point.probes.emplace_back(probe.name, probe.value);
  point.false_successes = static_cast<int>(std::count_if(run.steps.begin(), run.steps.end(), [](const StepRecord& r) {
    return r.claimed == Status::solved && r.status != Status::solved;
  }));
  if (point.outcome != "finished") return;
  point.status = to_string(s.status);
  point.message = s.message;
} catch (const std::exception& error) {
  point.status = "error";
  point.message = error.what();
}

}  // namespace

fs::path run_folder(const ChartProcess& process, const ChartPoint& point) {
  return process.folder / point.folder / "run";
}

std::vector<std::string> solve_words(const ChartJob& job, const ChartProcess& process) {
  std::vector<std::string> words{"taut", "solve", job.problem};
  for (const auto& [key, value] : job.overrides) words.insert(words.end(), {"--set", key + "=" + value});
  words.insert(words.end(),
               {"--threads", std::to_string(process.threads), "--max-seconds", fmt::format("{}", process.max_seconds)});
  if (job.max_linear_solves > 0)
    words.insert(words.end(), {"--max-linear-solves", std::to_string(job.max_linear_solves)});
  if (job.history_step > 0)
    words.insert(words.end(), {"--history", std::to_string(job.history_step), "--out", "history"});
  return words;
}

void run_point(const ChartProcess& process, const ChartJob& job, ChartPoint& point) {
  const fs::path folder = process.folder / point.folder, run = run_folder(process, point);
  point.command = solve_words(job, process);
  if (!process.resume || !take_over(folder / outcome_file, process.version, point)) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::vector<std::string> command = process.program;
    command.insert(command.end(), point.command.begin() + 1, point.command.end());
    if (job.history_step > 0) command.resize(command.size() - 2);
    command.insert(command.end(), {"--out", run.string(), "--format", "none", "--quiet"});
    const ChildLimits limits{.seconds = process.max_seconds + patience, .memory_bytes = process.memory_limit_bytes};
    const ChildOutcome child = run_child(command, folder / log_file, limits, process.stop);
    point.seconds = child.seconds;
    point.peak_memory_bytes = child.peak_memory_bytes;
    point.message = last_line(folder / log_file);
    point.outcome = outcome_of(child, point.message);
  }
  if (point.outcome == "interrupted") {
    point.status = point.outcome;
    return;
  }
  if (!point.resumed) write_outcome(folder / outcome_file, point, process.version);
  take_run(run, point);
}

}  // namespace taut
