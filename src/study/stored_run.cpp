#include "study/stored_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "files/atomic_file.h"
#include "problems/read_scene.h"
#include "study/records_json.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

std::vector<StepRecord> read_steps(const fs::path& file) {
  std::vector<StepRecord> steps;
  const std::string text = read_bytes(file);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string place = "line " + std::to_string(steps.size() + 1);
    try {
      steps.push_back(parse_step(std::string_view(text).substr(begin, end - begin)));
    } catch (const std::runtime_error& error) {
      throw FileError(file, place + ": " + error.what());
    }
    if (steps.back().step != static_cast<int>(steps.size())) {
      throw FileError(file, place + ": holds step " + std::to_string(steps.back().step) + ", a step is missing");
    }
    begin = end + 1;
  }
  return steps;
}

}  // namespace

StoredRun read_stored_run(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw RunRefused(folder.string() + ": there is no such directory");
  if (!fs::exists(folder / "checkpoint.bin")) throw RunRefused(folder.string() + ": holds no run (no checkpoint.bin)");
  StoredRun run;
  const RunFolder stored(folder);
  run.scene = read_scene(folder / "problem.json");
  std::optional<Continuation> checkpoint = stored.continuation(run.scene, 0);
  run.checkpoint = std::move(checkpoint.value());
  const fs::path summary = folder / "summary.json";
  if (!fs::exists(summary)) {
    throw RunRefused(summary.string() + ": is missing; the run was killed or is still going on (--resume ends it)");
  }
  try {
    run.summary = parse_summary(read_bytes(summary));
  } catch (const FileError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw FileError(summary, error.what());
  }
  run.steps = read_steps(folder / "steps.jsonl");
  if (static_cast<int>(run.steps.size()) != run.checkpoint.summary.steps_done) {
    throw FileError(folder / "steps.jsonl", fmt::format("holds {} steps where the checkpoint was written after {}",
                                                        run.steps.size(), run.checkpoint.summary.steps_done));
  }
  return run;
}

}  // namespace taut
