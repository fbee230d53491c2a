#include "study/lean_ladder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <variant>

#include "files/atomic_file.h"
#include "problems/body_shape.h"
#include "problems/read_scene.h"
#include "study/lean_omissions.h"

namespace taut {
namespace {

using Json = nlohmann::json;
using Kind = Simplification::Kind;

constexpr int most_halvings = 4;          // of a mesh
constexpr int fewest_dynamic_steps = 10;  // of a run in time
constexpr double loosest_tolerance = 1e-3;
constexpr double many_solves = 20;  // of a step; a dozen scenes of the catalogue took 4 to 16

int halved(int number, int times) { return std::max(1, static_cast<int>(std::lround(std::ldexp(number, -times)))); }

bool is_static(const Json& document) { return document["time"]["integrator"] == "static"; }

bool names_vertices(const Json& part) { return part.contains("select") && part["select"].contains("vertices"); }

/// Why the meshes of a scene cannot be made coarser; empty where they can.
std::string why_not_coarser(const Json& document) {
  for (const auto& [name, body] : document["bodies"].items()) {
    if (!body["mesh"].contains("grid")) return "the mesh of " + name + " is from a file";
    if (body.contains("cover") && !body["cover"]["mesh"].contains("refine"))
      return "the cover of " + name + " has a mesh of its own";
    if (body.contains("modal") && body["modal"].contains("basis")) return "the modes of " + name + " are from a file";
    if (body.contains("vertex_thickness")) return name + " has a thickness for each vertex";
  }
  for (const char* section : {"constraints", "loads"})
    for (const auto& [name, part] : document[section].items())
      if (names_vertices(part)) return name + " names vertices by number";
  for (const auto& [name, probe] : document["output"]["probes"].items())
    if (names_vertices(probe)) return "the probe " + name + " names vertices by number";
  return "";
}

/// True where every grid keeps two cells in each direction that had them, and four in one.
bool leaves_a_mesh(const Json& document, int times) {
  for (const auto& [name, body] : document["bodies"].items()) {
    const Json& cells = body["mesh"]["grid"]["cells"];
    const int x = halved(cells[0], times), y = halved(cells[1], times);
    if (x < std::min(2, cells[0].get<int>()) || y < std::min(2, cells[1].get<int>()) || std::max(x, y) < 4)
      return false;
  }
  return true;
}

void coarsen(Json& document, int times) {
  for (auto& [name, body] : document["bodies"].items()) {
    Json& cells = body["mesh"]["grid"]["cells"];
    cells = {halved(cells[0], times), halved(cells[1], times)};
  }
}

std::string cells_of(const Json& document) {
  const Json& cells = document["bodies"].begin().value()["mesh"]["grid"]["cells"];
  return fmt::format("{} x {} cells", cells[0].get<int>(), cells[1].get<int>());
}

void add_mesh(const Json& document, LeanLadder& ladder) {
  const std::string reason = why_not_coarser(document);
  if (!reason.empty()) {
    ladder.not_applicable.push_back({"mesh", reason});
    return;
  }
  Simplification mesh{.name = "mesh", .kind = Kind::refinement, .levels = {}, .cost_ratio = 4, .apply = coarsen};
  mesh.solve_ratio = 4;
  mesh.has_residual = is_static(document);
  for (int times = 0; times <= most_halvings && (times == 0 || leaves_a_mesh(document, times)); ++times) {
    Json coarse = document;
    coarsen(coarse, times);
    mesh.levels.push_back(cells_of(coarse));
  }
  if (mesh.levels.size() > 1)
    ladder.simplifications.push_back(std::move(mesh));
  else
    ladder.not_applicable.push_back({"mesh", "it is as coarse as it can be (" + mesh.levels[0] + ")"});
}

void lengthen_steps(Json& document, int times) {
  constexpr int halvings = 6;  // so that a load step that turns out too long is divided again
  Json& time = document["time"];
  const int before = time["steps"], after = halved(before, times);
  if (after == before) return;
  time["steps"] = after;
  if (is_static(document))
    time["halvings"] = std::max(halvings, time["halvings"].get<int>());
  else
    time["step"] = time["step"].get<double>() * before / after;
}

void add_steps(const Json& document, LeanLadder& ladder) {
  const int steps = document["time"]["steps"], fewest = is_static(document) ? 1 : fewest_dynamic_steps;
  Simplification step{
      .name = "step", .kind = Kind::refinement, .levels = {}, .cost_ratio = 1.8, .apply = lengthen_steps};
  for (int times = 0; times == 0 || (halved(steps, times) >= fewest && halved(steps, times) < halved(steps, times - 1));
       ++times) {
    Json longer = document;
    lengthen_steps(longer, times);
    const Json& time = longer["time"];
    const int left = time["steps"];
    step.levels.push_back(is_static(document) ? fmt::format("{} load step{}", left, left == 1 ? "" : "s")
                                              : fmt::format("{} steps of {:.3g} s", left, time["step"].get<double>()));
  }
  if (step.levels.size() > 1)
    ladder.simplifications.push_back(std::move(step));
  else
    ladder.not_applicable.push_back({"step", "there are too few steps (" + step.levels[0] + ")"});
}

void loosen(Json& document, int level) {
  for (auto& [name, tolerance] : document["solver"]["tolerance"].items()) {
    const double own = tolerance;
    tolerance = std::max(own, std::min(own * std::pow(10, level), loosest_tolerance));
  }
}

void add_tolerance(const Json& document, LeanLadder& ladder) {
  const double own = document["solver"]["tolerance"]["stationarity"];
  Simplification tolerance{
      .name = "tolerance", .kind = Kind::refinement, .levels = {}, .cost_ratio = 1.1, .apply = loosen};
  tolerance.has_residual = is_static(document);
  for (int level = 0; level == 0 || own * std::pow(10, level) <= 1.001 * loosest_tolerance; ++level)
    tolerance.levels.push_back(fmt::format("tolerance {:.1g}", own * std::pow(10, level)));
  if (tolerance.levels.size() > 1)
    ladder.simplifications.push_back(std::move(tolerance));
  else
    ladder.not_applicable.push_back({"tolerance", "it is loose as it is (" + tolerance.levels[0] + ")"});
}

/// Of a body that moves in its modes as it is written.
void add_modes(const Json& document, LeanLadder& ladder) {
  for (const auto& [name, body] : document["bodies"].items()) {
    if (!body.contains("modal")) continue;
    Simplification modes{.name = "modes", .kind = Kind::refinement, .levels = {}, .cost_ratio = 1.3, .apply = {}};
    modes.apply = [name = name](Json& json, int level) {
      Json& number = json["bodies"][name]["modal"]["modes"];
      number = halved(number, level);
    };
    const int own = body["modal"]["modes"];
    for (int level = 0; level == 0 || halved(own, level) < halved(own, level - 1); ++level)
      modes.levels.push_back(fmt::format("{} mode{}", halved(own, level), halved(own, level) == 1 ? "" : "s"));
    if (modes.levels.size() > 1) ladder.simplifications.push_back(std::move(modes));
  }
}

/// How many vertices each point load of a scene acts on.
std::vector<std::size_t> loaded_vertices(const Scene& scene) {
  std::vector<BodyShape> shapes;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k)
    shapes.push_back(make_body_shape(scene, k, k > 0 ? &shapes[k - 1] : nullptr));
  std::vector<std::size_t> numbers;
  for (const scene::Load& load : scene.loads) {
    const auto* point = std::get_if<scene::PointLoad>(&load.kind);
    if (!point) continue;
    numbers.push_back(selected_vertices(scene, shapes[static_cast<std::size_t>(load.body)], point->select,
                                        "/loads/" + load.name + "/select")
                          .size());
  }
  return numbers;
}

/// The force at each vertex of a point load, so that their sum stays.
void keep_sums(const Scene& full, const Scene& rung, Json& document) {
  const std::vector<std::size_t> before = loaded_vertices(full), after = loaded_vertices(rung);
  std::size_t k = 0;
  for (auto& [name, load] : document["loads"].items()) {
    if (load["type"] != "point_load") continue;
    for (Json& component : load["force"])
      component = component.get<double>() * static_cast<double>(before[k]) / static_cast<double>(after[k]);
    ++k;
  }
}

bool has_point_loads(const Scene& scene) {
  return std::any_of(scene.loads.begin(), scene.loads.end(),
                     [](const scene::Load& load) { return std::holds_alternative<scene::PointLoad>(load.kind); });
}

}  // namespace

bool is_full(const Levels& levels) {
  return std::all_of(levels.begin(), levels.end(), [](int level) { return level == 0; });
}

LeanLadder lean_ladder(const Scene& scene) {
  const Json document = Json::parse(scene.document);
  LeanLadder ladder;
  ladder.full_linear_solves = many_solves * scene.time.steps;
  add_mesh(document, ladder);
  add_steps(document, ladder);
  add_tolerance(document, ladder);
  add_modes(document, ladder);
  add_simpler_models(document, ladder);
  return ladder;
}

LeanLadder omissions_of(const Scene& scene) {
  const Json document = Json::parse(scene.document);
  LeanLadder ladder;
  add_tolerance(document, ladder);
  add_steps(document, ladder);
  add_modes(document, ladder);
  for (Simplification& setting : ladder.simplifications) {  // one level looser each
    setting.kind = Kind::omission;
    setting.levels.resize(2);
  }
  add_simpler_models(document, ladder);
  add_removals(document, ladder);
  return ladder;
}

void write_rung(const Scene& scene, const LeanLadder& ladder, const Levels& levels, const std::string& name,
                const std::filesystem::path& file) {
  Json document = Json::parse(scene.document);
  document["name"] = name;
  for (std::size_t k = 0; k < levels.size(); ++k)
    if (levels[k] > 0) ladder.simplifications[k].apply(document, levels[k]);
  const auto write = [&] {
    write_atomically(file, document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  };
  write();
  const Scene rung = read_scene(file);
  if (!has_point_loads(rung) || rung.loads.size() != scene.loads.size()) return;
  keep_sums(scene, rung, document);
  write();
}

std::string words_of(const LeanLadder& ladder, const Levels& levels) {
  if (is_full(levels)) return "as written";
  std::string words;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const Simplification& one = ladder.simplifications[k];
    const bool named = levels[k] > 0 || (one.kind == Kind::refinement && one.name != "tolerance");
    if (!named) continue;
    words += (words.empty() ? "" : ", ") + one.levels[static_cast<std::size_t>(levels[k])];
  }
  return words;
}

}  // namespace taut
