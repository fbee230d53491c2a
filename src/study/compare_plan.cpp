#include "study/compare_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "problems/build.h"
#include "study/solver_entries.h"

namespace taut {
namespace {

using Setting = Overrides::value_type;

std::string last_part(const std::string& key) { return key.substr(key.rfind('.') + 1); }

/// A key as labels show it: its last part, or all of it where two keys end alike.
std::string short_key(const std::string& key, const std::vector<Variation>& all) {
  const auto alike = std::count_if(all.begin(), all.end(),
                                   [&](const Variation& other) { return last_part(other.key) == last_part(key); });
  return alike > 1 ? key : last_part(key);
}

/// Every choice of one value per variation.
std::vector<Overrides> combinations(const std::vector<Variation>& variations) {
  std::vector<Overrides> all{{}};
  for (const Variation& variation : variations) {
    std::vector<Overrides> longer;
    for (const Overrides& start : all) {
      for (const std::string& value : variation.values) {
        longer.push_back(start);
        longer.back().emplace_back(variation.key, value);
      }
    }
    all = std::move(longer);
  }
  return all;
}

void check(const EntryChoice& choice) {
  if (choice.solvers.empty()) throw std::invalid_argument("EntryChoice: expected solvers, got none");
  for (std::size_t k = 0; k < choice.solvers.size(); ++k) {
    solver_entry(choice.solvers[k]);
    const auto begin = choice.solvers.begin();
    if (std::count(begin, choice.solvers.end(), choice.solvers[k]) > 1)
      throw InputError("--solvers: found " + choice.solvers[k] + " twice, allowed: each once");
  }
  if (!choice.reference.empty()) solver_entry(choice.reference, "--reference");
}

ChosenEntry choose(const EntryChoice& choice, const std::string& solver, const Overrides& varied,
                   const double* tolerance) {
  ChosenEntry entry;
  entry.label = entry.solver = solver;
  entry.overrides = choice.settings;
  for (const Setting& setting : solver_entry(solver).overrides) entry.overrides.push_back(setting);
  for (const auto& [key, value] : varied) {
    const std::string text = " " + short_key(key, choice.variations) + "=" + value;
    entry.label += text;
    if (!keeps_the_problem(key)) entry.group += text;
    entry.overrides.emplace_back(key, value);
  }
  if (tolerance) {
    entry.label += fmt::format(" tol={}", *tolerance);
    for (const char* residual : {"stationarity", "feasibility", "complementarity"})
      entry.overrides.emplace_back(std::string("solver.tolerance.") + residual, fmt::format("{}", *tolerance));
  }
  return entry;
}

PlannedEntry plan_entry(const std::filesystem::path& file, const ChosenEntry& chosen) {
  PlannedEntry entry{chosen, read_scene(file, chosen.overrides)};
  build_model(entry.scene);
  build_solver(entry.scene, 1);
  return entry;
}

}  // namespace

std::vector<ChosenEntry> chosen_entries(const EntryChoice& choice) {
  check(choice);
  std::vector<ChosenEntry> entries;
  for (const std::string& solver : choice.solvers) {
    for (const Overrides& varied : combinations(choice.variations)) {
      if (choice.tolerances.empty()) entries.push_back(choose(choice, solver, varied, nullptr));
      for (const double& tolerance : choice.tolerances) entries.push_back(choose(choice, solver, varied, &tolerance));
    }
  }
  return entries;
}

double diagonal(const Vector& positions) {
  const auto points = positions.reshaped(3, positions.size() / 3);
  return points.cols() == 0 ? 0 : (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

bool keeps_the_problem(const std::string& key) { return key.starts_with("solver.") || last_part(key) == "form"; }

Variation parse_variation(const std::string& text) {
  const std::size_t equals = text.find('=');
  Variation variation{text.substr(0, equals), {}};
  bool quoted = false;
  int depth = 0;
  if (equals != text.npos) variation.values.emplace_back();
  for (std::size_t i = equals; i != text.npos && ++i < text.size();) {
    const char c = text[i];
    if (c == '"') quoted = !quoted;
    if (!quoted && (c == '[' || c == '{')) ++depth;
    if (!quoted && (c == ']' || c == '}')) --depth;
    if (c == ',' && depth == 0 && !quoted) {
      variation.values.emplace_back();
    } else {
      variation.values.back() += c;
    }
  }
  const bool has_empty = std::count(variation.values.begin(), variation.values.end(), "") > 0;
  if (variation.key.empty() || variation.values.empty() || has_empty)
    throw InputError("--vary " + text +
                     ": expected KEY=V1,V2,..., as in constraints.limit.form=matrix,singular_values");
  return variation;
}

ProblemPlan plan_problem(const std::filesystem::path& file, const EntryChoice& choice) {
  const std::vector<ChosenEntry> entries = chosen_entries(choice);
  ProblemPlan plan;
  plan.file = file;
  const std::string& reference = choice.reference.empty() ? choice.solvers.front() : choice.reference;
  plan.reference = plan_entry(file, choose(choice, reference, {}, nullptr));
  plan.size = diagonal(build_model(plan.reference.scene)->start());
  for (const ChosenEntry& entry : entries) plan.entries.push_back(plan_entry(file, entry));
  return plan;
}

}  // namespace taut
