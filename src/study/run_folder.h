#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include "dynamics/stepper.h"
#include "files/json_lines.h"
#include "problems/scene.h"
#include "study/history.h"
#include "study/records.h"

namespace taut {

/// A run that cannot begin where and how it was asked to; what() is one line.
class RunRefused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Where an earlier process stopped.
struct Continuation {
  bool finished = false;  ///< nothing is left to do
  int threads = 1;
  State state;
  RunSummary summary;  ///< of the steps up to state.step
  /// What the last step started from, without its multipliers, so that the step can be posed and judged once more;
  /// nothing before the first step.
  std::optional<State> before;
};

/// The folder that a run writes to: checkpoint.bin, summary.json, steps.jsonl, problem.json, probes.csv where there are
/// probes, history.csv where a step was watched; frames and pictures are FrameOutput's.
class RunFolder {
 public:
  /// Only looks: nothing is written or removed before begin(). Throws RunRefused for a folder that is neither empty nor
  /// a run's.
  explicit RunFolder(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  /// What the checkpoint knows of this scene's run, or nothing where the folder is empty or missing. Throws RunRefused
  /// where the folder belongs to another problem, was run with another number of threads (0: any) or cannot be read.
  std::optional<Continuation> continuation(const Scene& scene, int threads) const;

  /// Starts with an empty log of steps; replaces an earlier run. Throws RunRefused where the folder cannot be made.
  void begin(const Scene& scene, const Continuation& start);
  /// Goes on after continuation(): drops what is later than it. Throws RunRefused where steps are missing.
  void go_on(const Scene& scene, const Continuation& from);

  void append_step(const StepRecord& record);
  void write_history(const std::vector<HistoryPoint>& points) const;
  /// Forces the steps to disk and replaces the checkpoint.
  void write_checkpoint(const std::string& input_hash, const Continuation& now);
  void write_summary(RunSummary& summary) const;

 private:
  void replace_checkpoint(const std::string& input_hash, const Continuation& now) const;
  std::filesystem::path file(const char* name) const { return path_ / name; }

  std::filesystem::path path_;
  std::optional<LineFile> steps_, probes_;
};

}  // namespace taut
