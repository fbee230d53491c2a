#include "study/chart_knob.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <variant>

#include "study/compare_plan.h"

namespace taut {
namespace {

const std::map<std::string, KnobKind> named_kinds{
    {"tolerance", KnobKind::tolerance},   {"step", KnobKind::step},       {"mesh", KnobKind::mesh},
    {"integrator", KnobKind::integrator}, {"penalty", KnobKind::penalty}, {"model", KnobKind::model}};

double positive_number(const std::string& knob, const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(number > 0) || !std::isfinite(number))
    throw InputError("--vary " + knob + ": found " + text + ", allowed: numbers above 0");
  return number;
}

/// How often `part` goes into `whole`. Throws InputError where that is no whole number.
int whole_steps(double whole, double part) {
  const double steps = std::round(whole / part);
  if (steps < 1 || steps > 1e9 || std::abs(steps * part - whole) > 1e-9 * whole)
    throw InputError(fmt::format("--vary step: found {}, allowed: what divides {}", part, whole));
  return static_cast<int>(steps);
}

bool is_static(const Scene& scene) { return scene.time.integrator == scene::Integrator::quasi_static; }

KnobValue step_value(double step, const Scene& scene) {
  KnobValue value{.label = fmt::format("{:g}", step), .number = step, .problem = "", .overrides = {}};
  if (is_static(scene)) {
    value.overrides.emplace_back("time.steps", std::to_string(whole_steps(1, step)));
  } else {
    value.overrides.emplace_back("time.step", fmt::format("{}", step));
    value.overrides.emplace_back("time.steps", std::to_string(whole_steps(scene.time.step * scene.time.steps, step)));
  }
  return value;
}

/// `width` of the cells relative to the problem's own.
KnobValue mesh_value(double width, const Scene& scene) {
  KnobValue value{.label = "", .number = width, .problem = "", .overrides = {}};
  for (const scene::Body& body : scene.bodies) {
    if (std::holds_alternative<scene::Refinement>(body.mesh)) continue;  // follows the body that it covers
    const auto* grid = std::get_if<scene::Grid>(&body.mesh);
    if (!grid) throw InputError("--vary mesh: " + body.name + " is a mesh from a file, allowed: grids");
    const auto cells = [&](int own) {
      const double number = std::round(own / width);
      if (number < 1 || std::abs(number * width - own) > 1e-9 * own)
        throw InputError(fmt::format("--vary mesh: {:g} times the {} x {} cells of {} are no whole cells", 1 / width,
                                     grid->cells_x, grid->cells_y, body.name));
      return static_cast<int>(number);
    };
    const int x = cells(grid->cells_x), y = cells(grid->cells_y);
    if (value.label.empty()) value.label = fmt::format("{}x{}", x, y);
    value.overrides.emplace_back("bodies." + body.name + ".mesh.grid.cells", fmt::format("[{},{}]", x, y));
  }
  return value;
}

KnobValue tolerance_value(double tolerance) {
  KnobValue value{.label = fmt::format("{:g}", tolerance), .number = tolerance, .problem = "", .overrides = {}};
  for (const char* residual : {"stationarity", "feasibility", "complementarity"})
    value.overrides.emplace_back(std::string("solver.tolerance.") + residual, fmt::format("{}", tolerance));
  return value;
}

/// A file, or KEY=VALUE;KEY=VALUE; a name and a colon may stand before either.
KnobValue model_value(const std::string& given) {
  const std::size_t colon = given.find(':');
  const bool named = colon != given.npos && colon > 0 && colon < given.find('=');
  const std::string text = named ? given.substr(colon + 1) : given;
  KnobValue value{.label = named ? given.substr(0, colon) : text, .problem = "", .overrides = {}};
  if (text.find('=') == text.npos) {
    value.problem = text;
    return value;
  }
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(';', begin), text.size());
    const std::string setting = text.substr(begin, end - begin);
    const std::size_t equals = setting.find('=');
    if (equals == setting.npos || equals == 0)
      throw InputError("--vary model: found " + setting +
                       ", allowed: a problem, or KEY=VALUE;KEY=VALUE, either with NAME: before it");
    value.overrides.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
    begin = end + 1;
  }
  return value;
}

/// Factors on the grid that leave whole cells: the problem's own mesh is the finest where it can be made coarser.
std::vector<double> suitable_widths(const Scene& scene) {
  for (const std::vector<double>& widths : {std::vector<double>{4, 2, 1}, std::vector<double>{2, 1, 0.5}}) {
    try {
      mesh_value(widths.front(), scene);
      return widths;
    } catch (const InputError&) {  // no whole cells
    }
  }
  return {1, 0.5, 0.25};
}

std::vector<double> suitable_numbers(KnobKind kind, const Scene& scene) {
  const double step = is_static(scene) ? 1.0 / scene.time.steps : scene.time.step;
  switch (kind) {
    case KnobKind::tolerance:
      return {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
    case KnobKind::step:
      return {step, step / 2, step / 4, step / 8};
    case KnobKind::mesh:
      return suitable_widths(scene);
    case KnobKind::penalty:
      return {1, 10, 100, 1e3, 1e4, 1e5};
    default:
      return {};
  }
}

bool is_numbered(KnobKind kind) {
  return kind == KnobKind::tolerance || kind == KnobKind::step || kind == KnobKind::mesh || kind == KnobKind::penalty;
}

}  // namespace

KnobChoice parse_knob(const std::string& text) {
  KnobChoice choice;
  const bool has_values = text.find('=') != text.npos;
  if (has_values) {
    const Variation variation = parse_variation(text);
    choice.name = variation.key;
    choice.values = variation.values;
  } else {
    choice.name = text;
  }
  const auto named = named_kinds.find(choice.name);
  choice.kind = named == named_kinds.end() ? KnobKind::key : named->second;
  if (!has_values && (choice.kind == KnobKind::key || choice.kind == KnobKind::model))
    throw InputError("--vary " + text +
                     ": expected tolerance, step, mesh, integrator or penalty, or one of these, model or a KEY of the "
                     "problem with =V1,V2,...");
  return choice;
}

KnobValue numbered_value(KnobKind kind, double number, const Scene& scene) {
  if (kind == KnobKind::step) return step_value(number, scene);
  if (kind == KnobKind::mesh) return mesh_value(number, scene);
  if (kind == KnobKind::tolerance) return tolerance_value(number);
  return {.label = fmt::format("{:g}", number),
          .number = number,
          .problem = "",
          .overrides = {{"solver.penalty", fmt::format("{}", number)}}};
}

std::vector<KnobValue> values_of(const KnobChoice& choice, const Scene& scene) {
  std::vector<KnobValue> values;
  if (choice.kind == KnobKind::none) return {KnobValue{.label = "", .problem = "", .overrides = {}}};
  if (is_numbered(choice.kind)) {
    std::vector<double> numbers;
    for (const std::string& text : choice.values) {
      const double number = positive_number(choice.name, text);
      numbers.push_back(choice.kind == KnobKind::mesh ? 1 / number : number);
    }
    if (numbers.empty()) numbers = suitable_numbers(choice.kind, scene);
    for (const double number : numbers) values.push_back(numbered_value(choice.kind, number, scene));
    return values;
  }
  std::vector<std::string> texts = choice.values;
  if (choice.kind == KnobKind::integrator) {
    if (is_static(scene))
      throw InputError("--vary integrator: " + scene.name + " is static, allowed: dynamic problems");
    if (texts.empty()) texts = {"implicit_euler", "bdf2", "generalised_alpha"};
  }
  for (const std::string& text : texts) {
    if (choice.kind == KnobKind::model) {
      values.push_back(model_value(text));
      continue;
    }
    KnobValue& value = values.emplace_back(KnobValue{.label = text, .problem = "", .overrides = {}});
    value.overrides.emplace_back(choice.kind == KnobKind::integrator ? "time.integrator" : choice.name, text);
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    if (*end == '\0') value.number = number;
  }
  return values;
}

bool keeps_the_problem(const KnobChoice& choice) {
  return choice.kind == KnobKind::none || choice.kind == KnobKind::tolerance || choice.kind == KnobKind::penalty ||
         (choice.kind == KnobKind::key && keeps_the_problem(choice.name));
}

}  // namespace taut
