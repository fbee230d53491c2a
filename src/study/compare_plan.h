#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "problems/read_scene.h"

namespace taut {

/// A key of the problem and the values that it takes in turn.
struct Variation {
  std::string key;
  std::vector<std::string> values;
};

/// "KEY=V1,V2,..." as a Variation; commas inside brackets, braces and quotes belong to a value. Throws InputError for
/// anything else.
Variation parse_variation(const std::string& text);

/// True for a key of which another value poses the same problem: how it is solved, or in which form a limit is written.
bool keeps_the_problem(const std::string& key);

/// The diagonal of the bounding box of points with 3 entries each, m; 0 for none.
double diagonal(const Vector& positions);

/// Which entries a comparison has: every solver with every combination of variations at every tolerance.
struct EntryChoice {
  std::vector<std::string> solvers;  ///< labels of solver_entries()
  std::string reference;             ///< label whose trajectory gives the states; empty: the first solver
  std::vector<Variation> variations;
  std::vector<double> tolerances;  ///< all three of the problem; none: the problem's own
  Overrides settings;              ///< of every entry, the reference included
};

struct ChosenEntry {
  std::string label, solver, group;  ///< as in EntryRun
  Overrides overrides;
};
/// Throws InputError for unknown solvers, std::invalid_argument for none.
std::vector<ChosenEntry> chosen_entries(const EntryChoice& choice);

struct PlannedEntry : ChosenEntry {
  Scene scene;
};

struct ProblemPlan {
  std::filesystem::path file;
  PlannedEntry reference;
  double size = 0;  ///< diagonal of the bounding box at the start, m
  std::vector<PlannedEntry> entries;
};

/// Reads the problem once for every entry and builds each, so that whatever is wrong with one is known before anything
/// is run. Throws InputError, and std::invalid_argument for a choice without solvers.
ProblemPlan plan_problem(const std::filesystem::path& file, const EntryChoice& choice);

}  // namespace taut
