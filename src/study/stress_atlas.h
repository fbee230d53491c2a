#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "problems/read_scene.h"

namespace taut {

/// One place on an entry's knob.
struct StressValue {
  std::string label;
  Overrides overrides;  ///< of the entry's problem
  bool quick = false;   ///< part of the quick atlas
};

/// A family of problems with a knob that is turned from easy to impossible.
struct StressEntry {
  std::string name, title;
  std::string knob;            ///< what is turned, with its unit
  std::string problem;         ///< as `taut solve` finds it: "stress/sheet"
  std::filesystem::path file;  ///< of the problem
  Overrides overrides;         ///< of every value
  std::vector<StressValue> values;
  std::vector<std::string> methods;           ///< labels of solver_entries()
  std::map<std::string, std::string> losses;  ///< why the default solver loses at a value, by label
};

/// Reads an atlas: a JSON file of "methods" and "entries"; problems are relative to the catalogue that holds the
/// atlas's folder. Keys of an entry: "title", "problem", "knob", "values" (strings that "key" takes, or objects of
/// "label" and "set"), and optionally "set", "quick" (labels), "methods", "losses". Throws InputError in one line for
/// anything that does not fit, unknown solvers included.
std::vector<StressEntry> read_stress_atlas(const std::filesystem::path& file);

}  // namespace taut
