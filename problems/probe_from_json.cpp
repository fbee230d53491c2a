#include "problems/probe_from_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace taut {

using namespace scene;

namespace {

constexpr std::array resultants{"n11", "n22", "n12", "m11", "m22", "m12", "q1", "q2"};
constexpr std::array stresses{"stress_11", "stress_22", "stress_33", "stress_12", "stress_13", "stress_23"};

bool is_resultant(const std::string& quantity) {
  return std::find(resultants.begin(), resultants.end(), quantity) != resultants.end();
}

}  // namespace

int ProbeReader::body_index(const Json& json, const std::string& pointer) const {
  const std::string name = json["body"];
  std::string names;
  for (std::size_t i = 0; i < bodies_->size(); ++i) {
    if ((*bodies_)[i].name == name) return static_cast<int>(i);
    names += (i == 0 ? "" : ", ") + (*bodies_)[i].name;
  }
  refuse(pointer + "/body", json["body"].dump(), names);
}

Selection ProbeReader::selection(const Json& json, int body, const std::string& pointer) const {
  const std::string kind = json.begin().key();
  const Json& value = json.begin().value();
  if ((kind == "corners" || kind == "edges") &&
      !std::holds_alternative<Grid>((*bodies_)[static_cast<std::size_t>(body)].mesh))
    refuse(pointer, "\"" + kind + "\" of a body with a mesh file", "corners and edges of grids only");
  if (kind == "vertices") return ByIndex{value.get<std::vector<int>>()};
  if (kind == "corners") return AtCorners{value.get<std::vector<std::string>>()};
  if (kind == "edges") return OnEdges{value.get<std::vector<std::string>>()};
  if (kind == "box") return box(value, pointer + "/box");
  if (kind == "sphere") return InBall{vector(value["center"]), value["radius"]};
  if (kind == "group") return InGroup{value};
  if (kind == "boundary") return OnBoundary{};
  if (kind == "all") return Everything{};
  NearestTo result;
  for (const Json& point : value) result.points.push_back(vector(point));
  return result;
}

InBox ProbeReader::box(const Json& json, const std::string& pointer) const {
  InBox result{vector(json["min"]), vector(json["max"])};
  for (int i = 0; i < 3; ++i)
    if (result.min[i] > result.max[i])
      refuse(fmt::format("{}/min/{}", pointer, i), json["min"][i].dump(),
             "a number <= that of max, which is " + json["max"][i].dump());
  return result;
}

Probe ProbeReader::probe(const std::string& name, const Json& json, const Time& time) const {
  const std::string pointer = "/output/probes/" + name;
  Probe result;
  result.name = name;
  const std::string quantity = json["quantity"];
  if (json.contains("body"))
    result.body = body_index(json, pointer);
  else if (bodies_->size() > 1)
    missing(pointer + "/body", "the name of a body, as there are several");
  const bool of_layer = quantity.starts_with("stress_") || quantity.starts_with("stretch_");
  const auto none_of = [&](std::initializer_list<const char*> keys) {
    for (const char* key : keys)
      if (json.contains(key)) refuse(pointer + "/" + key, json[key].dump(), "none of it for \"" + quantity + "\"");
  };
  if (!of_layer) none_of({"layer"});
  if (quantity != "frequency") none_of({"mode"});
  if (quantity == "energy") {
    none_of({"select", "surface"});
    result.quantity = Quantity::energy;
  } else if (quantity == "frequency") {
    none_of({"select", "surface"});
    result.quantity = Quantity::frequency;
    result.mode = json.value("mode", 1);
    if (result.mode > time.frequencies)
      refuse(pointer + "/mode", std::to_string(result.mode),
             "at most time.frequencies, which is " + std::to_string(time.frequencies));
  } else if (of_layer || is_resultant(quantity)) {
    shell_probe(quantity, json, pointer, result);
  } else {
    if (!json.contains("select")) missing(pointer + "/select", "a selection");
    result.select = selection(json["select"], result.body, pointer + "/select");
    const Body& on = (*bodies_)[static_cast<std::size_t>(result.body)];
    result.surface = surface(json, on, pointer, Surface::both, !quantity.starts_with("force_"));
    result.quantity = quantity == "displacement"              ? Quantity::displacement_length
                      : quantity.starts_with("displacement_") ? Quantity::displacement
                      : quantity.starts_with("force_")        ? Quantity::force
                                                              : Quantity::position;
    if (result.quantity != Quantity::displacement_length) result.axis = quantity.back() - 'x';
  }
  result.factor = json["factor"];
  if (json.contains("expected")) result.expected = expected(json["expected"], pointer + "/expected");
  return result;
}

void ProbeReader::shell_probe(const std::string& quantity, const Json& json, const std::string& pointer,
                              Probe& result) const {
  const Body& on = (*bodies_)[static_cast<std::size_t>(result.body)];
  if (!on.shell)
    refuse(pointer + "/quantity", "\"" + quantity + "\" of " + on.name + ", which is cloth", "it of thick shells only");
  if (!json.contains("select")) missing(pointer + "/select", "a selection");
  result.select = selection(json["select"], result.body, pointer + "/select");
  if (is_resultant(quantity)) {
    if (json.contains("surface"))
      refuse(pointer + "/surface", json["surface"].dump(), "none of it for \"" + quantity + "\"");
    result.quantity = Quantity::resultant;
    result.axis = static_cast<int>(std::find(resultants.begin(), resultants.end(), quantity) - resultants.begin());
    return;
  }
  result.quantity = quantity.starts_with("stretch_") ? Quantity::stretch : Quantity::stress;
  result.axis = result.quantity == Quantity::stretch
                    ? quantity.back() - '1'
                    : static_cast<int>(std::find(stresses.begin(), stresses.end(), quantity) - stresses.begin());
  result.layer = json.value("layer", 0);
  if (result.layer >= static_cast<int>(on.shell->layers.size()))
    refuse(pointer + "/layer", std::to_string(result.layer),
           "less than the number of layers, " + std::to_string(on.shell->layers.size()));
  result.surface = surface(json, on, pointer, Surface::top, true);
  if (result.surface == Surface::both) refuse(pointer + "/surface", "\"both\"", "bottom, top, mid");
}

Expected ProbeReader::expected(const Json& json, const std::string& pointer) const {
  const auto relative = optional_number(json, "relative"), absolute = optional_number(json, "absolute");
  if (relative.has_value() == absolute.has_value())
    throw InputError(source_, pointer,
                     std::string("found ") + (relative ? "both" : "neither") +
                         " of \"relative\" and \"absolute\", allowed: exactly one of them");
  return {json["value"], relative ? *relative : *absolute, relative.has_value(), json["source"]};
}

}  // namespace taut
