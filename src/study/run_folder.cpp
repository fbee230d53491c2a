#include "study/run_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "files/checkpoint.h"
#include "study/frame_output.h"
#include "study/records_json.h"
#include "study/state_arrays.h"

namespace taut {
namespace fs = std::filesystem;
namespace {
constexpr const char* checkpoint_file = "checkpoint.bin";
constexpr const char* summary_file = "summary.json";
constexpr const char* steps_file = "steps.jsonl";
constexpr const char* problem_file = "problem.json";
constexpr const char* probes_file = "probes.csv";
constexpr const char* history_file = "history.csv";
constexpr const char* before_prefix = "before ";

/// The state before the last step, under names of its own. Its positions and velocities are the previous ones of the
/// state after it, and its multipliers did not enter the step.
void add_before(const State& before, Checkpoint& checkpoint) {
  const auto all = state_arrays(before);
  for (const char* name : {"accelerations", "previous_positions", "previous_velocities", "auxiliary_accelerations"}) {
    checkpoint.arrays[std::string(before_prefix) + name] = all.at(name);
  }
}

/// Nothing before the first step and in checkpoints of earlier versions.
std::optional<State> before(const Checkpoint& checkpoint) {
  NamedArrays arrays;
  for (const auto& [name, array] : checkpoint.arrays) {
    if (name.starts_with(before_prefix)) arrays[name.substr(std::string_view(before_prefix).size())] = array;
  }
  if (arrays.empty()) return {};
  arrays["positions"] = checkpoint.arrays.at("previous_positions");
  arrays["velocities"] = checkpoint.arrays.at("previous_velocities");
  arrays["penalties"] = {};
  arrays["force_scale"] = {0.0};
  arrays["changes"] = {};
  return state_from(static_cast<int>(checkpoint.step) - 1, arrays);
}

bool is_empty_or_missing(const fs::path& folder) {
  std::error_code error;
  const bool empty = fs::is_empty(folder, error);
  return error ? !fs::exists(folder, error) : empty;
}

bool holds_a_run(const fs::path& folder) {
  try {
    read_checkpoint(folder / checkpoint_file);
    return true;
  } catch (const std::exception&) {
  }
  try {
    parse_summary(read_bytes(folder / summary_file));
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

/// The completed problem under its own name, which it need not hold where that was the file's.
std::string problem_text(const Scene& scene) {
  nlohmann::json document = nlohmann::json::parse(scene.document);
  document["name"] = scene.name;
  return document.dump(2) + "\n";
}

}  // namespace

RunFolder::RunFolder(fs::path path) : path_(std::move(path)) {
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_directory(path_, error)) {
    throw RunRefused(path_.string() + ": is not a directory");
  }
  if (!is_empty_or_missing(path_) && !holds_a_run(path_)) {
    throw RunRefused(path_.string() +
                     ": is not empty and holds no run of taut; nothing was touched, choose another directory");
  }
}

std::optional<Continuation> RunFolder::continuation(const Scene& scene, int threads) const try {
  if (is_empty_or_missing(path_)) return {};
  const Checkpoint checkpoint = read_checkpoint(file(checkpoint_file));
  if (checkpoint.input_hash != scene.hash) {
    throw RunRefused(path_.string() + ": belongs to another problem (its hash is " + checkpoint.input_hash +
                     ", that of this one " + scene.hash + ")");
  }
  Continuation from;
  from.finished = checkpoint.texts.at("finished") == "yes";
  from.threads = std::stoi(checkpoint.texts.at("threads"));
  if (threads != 0 && threads != from.threads) {
    throw RunRefused(path_.string() + ": was run with " + std::to_string(from.threads) + " threads, not " +
                     std::to_string(threads) + "; another number gives other bits");
  }
  from.state = state_from(static_cast<int>(checkpoint.step), checkpoint.arrays);
  from.summary = parse_summary(checkpoint.texts.at("summary"));
  from.before = before(checkpoint);
  return from;
} catch (const RunRefused&) {
  throw;
} catch (const std::exception& error) {
  throw RunRefused(path_.string() + ": its checkpoint cannot be used: " + error.what());
}

void RunFolder::begin(const Scene& scene, const Continuation& start) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) throw RunRefused(path_.string() + ": cannot be created: " + error.message());
  // First the checkpoint: killed at any point after it, the folder is a run's that resumes from the beginning.
  replace_checkpoint(scene.hash, start);
  fs::remove(file(summary_file));
  fs::remove(file(history_file));
  remove_frames_after(path_, -1);
  steps_.emplace(file(steps_file));
  fs::remove(file(probes_file));
  if (!scene.output.probes.empty()) {
    probes_.emplace(file(probes_file));
    std::string head = "step,time";
    for (const scene::Probe& probe : scene.output.probes) head += "," + probe.name;
    probes_->append(head);
  }
  write_atomically(file(problem_file), problem_text(scene));
}

void RunFolder::go_on(const Scene& scene, const Continuation& from) try {
  steps_.emplace(file(steps_file), from.state.step);
  if (!scene.output.probes.empty()) probes_.emplace(file(probes_file), from.state.step + 1);
  fs::remove(file(summary_file));
} catch (const FileError& error) {
  throw RunRefused(std::string(error.what()) + "; cannot be resumed");
}

void RunFolder::append_step(const StepRecord& record) {
  steps_->append(step_line(record));
  if (!probes_) return;
  std::string line = fmt::format("{},{}", record.step, record.time);
  for (const auto& [name, value] : record.probes) line += fmt::format(",{}", value);
  probes_->append(line);
}

void RunFolder::write_history(const std::vector<HistoryPoint>& points) const {
  write_atomically(file(history_file), history_csv(points));
}

void RunFolder::write_checkpoint(const std::string& input_hash, const Continuation& now) {
  steps_->sync();
  if (probes_) probes_->sync();
  replace_checkpoint(input_hash, now);
}

void RunFolder::replace_checkpoint(const std::string& input_hash, const Continuation& now) const {
  Checkpoint checkpoint{input_hash, now.state.step, state_arrays(now.state), {}};
  if (now.before) add_before(*now.before, checkpoint);
  checkpoint.texts["finished"] = now.finished ? "yes" : "no";
  checkpoint.texts["threads"] = std::to_string(now.threads);
  checkpoint.texts["summary"] = summary_text(now.summary);
  taut::write_checkpoint(file(checkpoint_file), checkpoint);
}

void RunFolder::write_summary(RunSummary& summary) const {
  summary.files = {checkpoint_file, problem_file, steps_file, summary_file};
  if (probes_) summary.files.emplace_back(probes_file);
  if (fs::exists(file(history_file))) summary.files.emplace_back(history_file);
  for (const auto& entry : fs::recursive_directory_iterator(path_)) {
    const std::string extension = entry.path().extension().string();
    const bool ours = extension == ".vtu" || extension == ".obj" || extension == ".svg" || extension == ".pvd";
    if (ours && entry.is_regular_file()) summary.files.push_back(fs::relative(entry.path(), path_).string());
  }
  std::sort(summary.files.begin(), summary.files.end());
  write_atomically(file(summary_file), summary_text(summary));
}

}  // namespace taut
