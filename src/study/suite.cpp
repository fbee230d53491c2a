#include "study/suite.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include "study/child_process.h"
#include "study/compare_job.h"
#include "study/compare_records.h"
#include "study/machine.h"
#include "study/suite_json.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

/// The worker keeps to its time by itself; this much later it is ended.
constexpr double patience = 1;  // s

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> parts;
  std::istringstream text(line);
  for (std::string part; std::getline(text, part, ',');) parts.push_back(part);
  if (!parts.empty() && parts.back().ends_with('\r')) parts.back().pop_back();
  return parts;
}

std::map<std::string, double> read_references(const fs::path& path) {
  std::map<std::string, double> references;
  std::ifstream file(path);
  std::string line;
  if (!std::getline(file, line)) return references;
  const std::vector<std::string> header = cells(line);
  const auto column = [&](std::initializer_list<const char*> names) {
    const auto found = std::find_first_of(header.begin(), header.end(), names.begin(), names.end());
    if (found == header.end())
      throw InputError(path.string() + ": found the columns " + line + ", allowed: name and f (or best_known_f)");
    return static_cast<std::size_t>(found - header.begin());
  };
  const std::size_t name = column({"name"}), value = column({"f", "best_known_f"});
  while (std::getline(file, line)) {
    const std::vector<std::string> row = cells(line);
    if (row.size() <= std::max(name, value) || row[value].empty()) continue;
    char* end = nullptr;
    const double f = std::strtod(row[value].c_str(), &end);
    if (*end != '\0')
      throw InputError(path.string() + ": found " + row[value] + " for " + row[name] + ", allowed: a number");
    references[row[name]] = f;
  }
  return references;
}

std::vector<SuiteModel> find_models(const fs::path& folder) {
  std::error_code error;
  std::vector<SuiteModel> models;
  for (const auto& file : fs::directory_iterator(folder, error)) {
    if (file.path().extension() == ".nl") models.push_back({file.path().stem().string(), file.path().string(), {}});
  }
  if (models.empty()) throw InputError(folder.string() + ": found no .nl files, allowed: a folder of models");
  std::sort(models.begin(), models.end(), [](const SuiteModel& a, const SuiteModel& b) { return a.name < b.name; });
  const std::map<std::string, double> references = read_references(folder / "reference.csv");
  for (SuiteModel& model : models) {
    if (const auto found = references.find(model.name); found != references.end()) model.reference = found->second;
  }
  return models;
}

SuiteRun run_model(const SuiteOptions& options, const SuiteModel& model, const SuiteEntry& entry) {
  std::vector<std::string> command = options.worker;
  command.insert(command.end(), {model.file, "--repeat", std::to_string(options.repeat)});
  if (options.time_limit > 0) command.insert(command.end(), {"--max-seconds", fmt::format("{}", options.time_limit)});
  for (const auto& [key, value] : entry.chosen.overrides) command.insert(command.end(), {"--set", key + "=" + value});
  const fs::path log = options.logs / "log.txt";
  const ChildLimits limits{.seconds = options.time_limit > 0 ? options.time_limit + patience : 0,
                           .memory_bytes = options.memory_limit_bytes};
  const std::string outcome = outcome_of(run_child(command, log, limits, options.stop));
  if (outcome == "finished") return parse_suite_run(last_line(log));
  SuiteRun run;
  run.outcome = outcome;
  run.message = last_line(log);
  return run;
}

double median(const std::vector<double>& values) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : spread_of(values).median;
}

}  // namespace

Suite run_suite(const SuiteOptions& options) {
  Suite suite;
  suite.folder = options.folder.string();
  suite.models = find_models(options.folder);
  for (const ChosenEntry& chosen : chosen_entries(options.choice)) suite.entries.push_back({chosen, {}});
  suite.repeat = options.repeat;
  suite.time_limit = options.time_limit;
  suite.version = options.version;
  suite.machine = this_machine();
  for (const SuiteEntry& entry : suite.entries) read_model_settings(suite.models.front().file, entry.chosen.overrides);
  if (options.on_start) options.on_start(static_cast<int>(suite.models.size() * suite.entries.size()));
  const auto stopped = [&] { return options.stop && options.stop->load(std::memory_order_relaxed); };
  for (const SuiteModel& model : suite.models) {
    for (SuiteEntry& entry : suite.entries) {
      const SuiteRun& run = entry.runs.emplace_back(stopped() ? SuiteRun{} : run_model(options, model, entry));
      if (options.on_run) options.on_run(model, entry, run);
    }
  }
  suite.interrupted = stopped();
  return suite;
}

bool is_correct(const SuiteModel& model, const SuiteRun& run) {
  if (!model.reference) return run.solved();
  if (run.outcome != "finished" || !(run.violation <= 1e-6)) return false;
  const double known = *model.reference;
  return std::abs(run.objective - known) <= 1e-5 * std::max(1.0, std::abs(known)) || is_better_than_known(model, run);
}

bool is_better_than_known(const SuiteModel& model, const SuiteRun& run) {
  if (!model.reference || run.outcome != "finished" || run.violation != 0) return false;
  const double known = *model.reference, gain = run.maximise ? run.objective - known : known - run.objective;
  return std::isfinite(gain) && gain > 1e-5 * std::max(1.0, std::abs(known));
}

SuiteScore score_of(const Suite& suite, const SuiteEntry& entry) {
  SuiteScore score;
  std::vector<double> finished, counted, solves;
  for (std::size_t k = 0; k < suite.models.size(); ++k) {
    const SuiteRun& run = entry.runs[k];
    const bool correct = is_correct(suite.models[k], run);
    score.false_successes += run.false_success;
    score.correct += correct;
    score.solved += run.solved();
    counted.push_back(correct ? run.seconds : suite.time_limit);
    if (run.outcome != "finished") continue;
    finished.push_back(run.seconds);
    solves.push_back(static_cast<double>(run.counts.linear_solves));
  }
  score.median_seconds = median(finished);
  score.linear_solves = median(solves);
  score.mean_seconds = shifted_geometric_mean(counted, suite_mean_shift);
  return score;
}

std::vector<Profile> performance_of(const Suite& suite) {
  Matrix costs(static_cast<Index>(suite.models.size()), static_cast<Index>(suite.entries.size()));
  for (std::size_t model = 0; model < suite.models.size(); ++model) {
    for (std::size_t k = 0; k < suite.entries.size(); ++k) {
      const SuiteRun& run = suite.entries[k].runs[model];
      // A clock of zero would have no logarithm.
      costs(static_cast<Index>(model), static_cast<Index>(k)) =
          is_correct(suite.models[model], run) ? std::max(run.seconds, 1e-9) : std::numeric_limits<double>::infinity();
    }
  }
  return performance_profiles(costs);
}

}  // namespace taut
