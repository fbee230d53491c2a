#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "problems/schema.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
using Lines = std::vector<std::pair<std::string, std::string>>;  // name and what it is

Lines problems() {
  Lines lines;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(catalogue_folder(), missing)) {
    if (entry.path().extension() != ".json") continue;
    std::ifstream file(entry.path());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    lines.emplace_back(entry.path().stem().string(),
                       parse_strict(text, entry.path().string()).value("description", ""));
  }
  if (lines.empty()) throw std::runtime_error(catalogue_folder().string() + ": the catalogue of problems is not there");
  std::sort(lines.begin(), lines.end());
  return lines;
}

Lines solvers() {
  return {
      {"augmented_lagrangian",
       "slacks eliminated by projection, semismooth Newton inside, sparse Cholesky; multipliers carried from step to "
       "step"},
      {"null_space",
       "the same with pins kept in the null space of their equations and another factorisation: a "
       "check"},
      {"alternating",
       "a cover and its shell in turn, with a penalty and multipliers between them: a comparison, for scenes with "
       "covers"},
      {"ipopt",
       "Ipopt's interior-point method on a smooth scalar form of the constraints, with exact second derivatives"},
      {"nlopt", "algorithms of NLopt (key: solver.nlopt.algorithm) on the same form; small problems only"}};
}

Lines energies() {
  return {
      {"inertia", "mass of each body, lumped or consistent (key: mass); absent in static problems"},
      {"gravity", "a constant acceleration of everything (key: gravity)"},
      {"membrane stvk", "plane-stress St. Venant-Kirchhoff: linear in the Green strain (key: membrane.law)"},
      {"membrane neo_hookean", "plane-stress neo-Hookean: resists collapse of a triangle (key: membrane.law)"},
      {"bending", "discrete hinges at the inner edges, with rest angles (key: bending)"},
      {"thick_shell", "six-node prisms in layers, stvk, neo_hookean or with fibres (keys: model, material, layers)"},
      {"damping", "Rayleigh damping by mass and by stiffness (key: damping)"},
      {"point_load", "a constant force at vertices (loads, type)"},
      {"edge_load", "a constant force per length along boundary edges (loads, type)"},
      {"surface_load", "a constant force per area (loads, type)"},
      {"end_moment", "a moment that turns an edge of a thick shell about a fixed axis (loads, type)"},
      {"pressure", "pressure times enclosed volume, for closed surfaces or fixed boundaries (loads, type)"},
      {"wind", "air drag; it has no potential and is held constant within a step (loads, type)"}};
}

/// The types of constraints with their descriptions in the schema, which is what problem files may say.
Lines constraints() {
  const Json definitions = Json::parse(problem_schema()).at("definitions");
  Lines lines;
  for (const Json& branch : definitions.at("constraint").at("oneOf")) {
    const std::string reference = branch.at("$ref");
    const Json& definition = definitions.at(reference.substr(reference.rfind('/') + 1));
    lines.emplace_back(definition.at("properties").at("type").at("const"), definition.at("description"));
  }
  return lines;
}

int print(const Lines& lines) {
  std::size_t width = 0;
  for (const auto& [name, text] : lines) width = std::max(width, name.size());
  for (const auto& [name, text] : lines) fmt::print("{:<{}}  {}\n", name, width, text);
  return std::fflush(stdout) == 0 ? exit_solved : exit_internal_error;
}

}  // namespace

fs::path catalogue_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  const fs::path installed = program.parent_path().parent_path() / "share" / "taut" / "catalogue";
  return !error && fs::is_directory(installed, error) ? installed : fs::path(TAUT_CATALOGUE);
}

void add_list(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("list", "List problems, solvers, energies or constraints, a line each");
  command->footer(
      "\nProblems are those of the catalogue, which `taut solve NAME` knows by name. Energies and constraints\n"
      "are what a problem file may name; `taut schema` has every key.");
  const std::vector<std::pair<std::string, Lines (*)()>> lists{
      {"problems", problems}, {"solvers", solvers}, {"energies", energies}, {"constraints", constraints}};
  command->require_subcommand(1);
  for (const auto& [name, lines] : lists) {
    command->add_subcommand(name, "List " + name)->callback([&code, make = lines] { code = print(make()); });
  }
}

}  // namespace taut
