#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "files/atomic_file.h"
#include "files/checkpoint.h"
#include "files/vtu.h"
#include "study/run.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/tiny_scene.h"

namespace taut {

/// A test with a run of tiny_scene() in a folder, whose files it changes.
class TamperedRunTest : public FilesTest {
 protected:
  using Json = nlohmann::ordered_json;

  std::filesystem::path folder() const { return path("run"); }
  Scene scene(const Overrides& overrides = {}) const { return tiny_scene(path("."), overrides); }

  RunSummary solve(const Scene& scene, int stop_after = 0) {
    RunOptions options;
    options.folder = folder();
    options.threads = 1;
    options.stop = &stop_;
    options.resume = std::filesystem::exists(folder());
    options.on_step = [&](const StepRecord& record) { stop_ = record.step == stop_after; };
    const RunSummary summary = run(scene, options);
    stop_ = false;
    return summary;
  }

  std::filesystem::path frame(int step) const {
    return folder() / "frames" / ("tiny_0000" + std::to_string(step) + ".vtu");
  }
  void change_frame(int step, const std::function<void(Frame&)>& change) {
    Frame content = read_vtu(frame(step));
    change(content);
    write_vtu(frame(step), content);
  }
  void change_checkpoint(const std::function<void(Checkpoint&)>& change) {
    Checkpoint content = read_checkpoint(folder() / "checkpoint.bin");
    change(content);
    write_checkpoint(folder() / "checkpoint.bin", content);
  }
  void change_summary(const std::function<void(Json&)>& change) {
    Json content = Json::parse(read_bytes(folder() / "summary.json"));
    change(content);
    write_atomically(folder() / "summary.json", content.dump(2));
  }
  void change_steps(const std::function<void(int step, Json&)>& change) {
    std::ifstream file(folder() / "steps.jsonl");
    std::string text;
    for (std::string line; std::getline(file, line);) {
      Json content = Json::parse(line);
      change(content["step"], content);
      text += content.dump() + "\n";
    }
    write_atomically(folder() / "steps.jsonl", text);
  }

 private:
  std::atomic<bool> stop_{false};
};

}  // namespace taut
