#include "study/lean_omissions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace taut {
namespace {

using Json = nlohmann::json;

void add(LeanLadder& ladder, const std::string& name, std::vector<std::string> levels,
         std::function<void(Json&, int)> apply) {
  levels.insert(levels.begin(), "as written");
  ladder.simplifications.push_back({.name = name,
                                    .kind = Simplification::Kind::omission,
                                    .levels = std::move(levels),
                                    .cost_ratio = 1,
                                    .apply = std::move(apply)});
}

void refuse(LeanLadder& ladder, const std::string& name, const std::string& reason) {
  ladder.not_applicable.push_back({name, reason});
}

/// One homogeneous layer as thick and heavy as all layers, with the same stiffness against stretching in its plane and
/// the mean of Poisson's ratios. Nothing where they are plies or follow different laws, or their thickness is not
/// known.
std::optional<Json> merged_layer(const Json& body) {
  if (body.contains("top") || body.contains("vertex_thickness")) return {};
  if (!body.contains("layers")) {
    if (!body.contains("material") || !body["material"].contains("law")) return {};
    return Json{{"thickness", body["thickness"]}, {"density", body["density"]}, {"material", body["material"]}};
  }
  double thickness = 0, mass = 0, stretching = 0, poisson = 0;
  const Json& first = body["layers"][0]["material"];
  for (const Json& layer : body["layers"]) {
    const Json& material = layer["material"];
    if (!material.contains("law") || material["law"] != first["law"]) return {};
    const double t = layer["thickness"], nu = material["poisson_ratio"], modulus = material["young_modulus"];
    thickness += t;
    mass += t * layer["density"].get<double>();
    stretching += t * modulus / (1 - nu * nu);
    poisson += t * nu;
  }
  const double nu = poisson / thickness;
  return Json{
      {"thickness", thickness},
      {"density", mass / thickness},
      {"material",
       {{"law", first["law"]}, {"young_modulus", stretching / thickness * (1 - nu * nu)}, {"poisson_ratio", nu}}}};
}

bool is_thick(const Json& body) { return body.contains("layers") || body.contains("material"); }

void put_layer(Json& body, const Json& layer) {
  body.erase("layers");
  body.update(layer);
}

/// A plate's plane stress and, where it is to have one, bending stiffness, as a sheet has them. Its only surface needs
/// no name.
void make_sheet(Json& document, const std::string& name, bool bends) {
  Json& body = document["bodies"][name];
  const std::optional<Json> layer = merged_layer(body);
  if (!layer) return;
  const Json& material = (*layer)["material"];
  const double t = (*layer)["thickness"], nu = material["poisson_ratio"], modulus = material["young_modulus"];
  put_layer(body, *layer);
  body.erase("material");
  if (body["model"] == "thick_shell") body["model"] = "cloth";
  body["membrane"] = material;
  if (bends) body["bending"] = {{"stiffness", modulus * t * t * t / (12 * (1 - nu * nu))}};
  const bool alone = document["bodies"].size() == 1;
  for (Json* parts : {&document["constraints"], &document["loads"], &document["output"]["probes"]})
    for (Json& part : *parts)
      if (part.contains("body") ? part["body"] == name : alone) part.erase("surface");
}

bool ends_with_msh(const Json& body) {
  return body["mesh"].contains("file") && body["mesh"]["file"].get<std::string>().ends_with(".msh");
}

void add_thick_shells(const std::string& name, const Json& body, LeanLadder& ladder) {
  if (!is_thick(body) || ends_with_msh(body)) return;
  const std::string sheet = "thick shell " + name;
  if (!merged_layer(body)) {
    refuse(ladder, sheet, "it has plies, layers of different laws, or a thickness that varies");
    return;
  }
  add(ladder, sheet, {name + " as a sheet", name + " as a membrane without bending"},
      [name](Json& json, int level) { make_sheet(json, name, level == 1); });
  if (!body.contains("layers")) return;
  const Json& layers = body["layers"];
  const bool divided = std::any_of(layers.begin(), layers.end(), [](const Json& l) { return l["prisms"] > 1; });
  if (layers.size() == 1 && !divided) return;
  add(ladder, "layers of " + name, {layers.size() == 1 ? "one prism through " + name : "layers of " + name + " merged"},
      [name](Json& json, int) {
        Json& shell = json["bodies"][name];
        if (const auto layer = merged_layer(shell); layer && shell.contains("layers")) put_layer(shell, *layer);
      });
}

/// Whether a constraint, load or probe is of the body.
bool is_used(const Json& document, const std::string& body) {
  const auto names = [&](const Json& parts) {
    return std::any_of(parts.begin(), parts.end(), [&](const Json& part) { return part.value("body", "") == body; });
  };
  return names(document["constraints"]) || names(document["loads"]) || names(document["output"]["probes"]);
}

/// Leaves out a cover and the strain limits and pins on it.
void remove_cover(Json& document, const std::string& name) {
  Json& body = document["bodies"][name];
  body.erase("cover");
  body["model"] = body.contains("membrane") || body.contains("bending") ? "cloth" : "thick_shell";
  Json kept = Json::object();
  for (const auto& [key, constraint] : document["constraints"].items())
    if (constraint["body"] != name + "/cover") kept[key] = constraint;
  document["constraints"] = kept;
}

void add_cover(const Json& document, const std::string& name, const Json& body, LeanLadder& ladder) {
  if (!body.contains("cover")) return;
  const std::string title = "cover of " + name;
  Json without = document;
  remove_cover(without, name);
  const bool may_go = !is_used(without, name + "/cover");
  std::vector<std::string> levels;
  const int own = body["cover"]["mesh"].value("refine", 0);
  for (int refine = own - 1; refine >= 1; --refine)
    levels.push_back(fmt::format("cover of {} at ratio {}", name, 1 << refine));
  const int coarser = static_cast<int>(levels.size());
  if (may_go) levels.push_back(name + " without its cover");
  if (!may_go) refuse(ladder, title + ": none", "a load or a probe is on it");
  if (levels.empty()) return;
  add(ladder, title, levels, [name, own, coarser](Json& json, int level) {
    if (level > coarser)
      remove_cover(json, name);
    else
      json["bodies"][name]["cover"]["mesh"]["refine"] = own - level;
  });
}

void add_bending(const std::string& name, const Json& body, LeanLadder& ladder) {
  const auto without = [&ladder](const std::string& title, const Json& sheet, std::function<Json*(Json&)> find) {
    if (!sheet.contains("bending")) return;
    if (!sheet.contains("membrane")) {
      refuse(ladder, title, "nothing would hold the body together");
      return;
    }
    add(ladder, title, {"without " + title}, [find](Json& json, int) {
      if (Json* found = find(json)) found->erase("bending");
    });
  };
  without("bending of " + name, body, [name](Json& json) { return &json["bodies"][name]; });
  if (!body.contains("cover")) return;
  without("bending of " + name + "/cover", body["cover"], [name](Json& json) -> Json* {
    Json& shell = json["bodies"][name];
    return shell.contains("cover") ? &shell["cover"] : nullptr;
  });
}

void add_limits(const Json& document, LeanLadder& ladder) {
  for (const auto& [name, constraint] : document["constraints"].items()) {
    if (constraint["type"] != "strain_limit") continue;
    add(ladder, "strain limit " + name, {"without strain limit " + name},
        [name = name](Json& json, int) { json["constraints"].erase(name); });
  }
}

/// A pin that holds vertices where they start, through the whole thickness.
bool is_clamp(const Json& constraint) {
  return constraint["type"] == "pin" && constraint.value("axes", "xyz") == "xyz" &&
         constraint.value("surface", "both") == "both" &&
         (!constraint.contains("motion") || constraint["motion"].value("keyframes", Json::array()).empty()) &&
         (!constraint.contains("motion") || !constraint["motion"].contains("velocity") ||
          constraint["motion"]["velocity"] == Json({0.0, 0.0, 0.0}));
}

/// Why a scene cannot move in its modes; empty where it can.
std::string why_no_modes(const Json& document) {
  if (document["bodies"].size() != 1) return "there are several bodies";
  const Json& body = document["bodies"].begin().value();
  if (body.contains("modal")) return "it moves in modes as it is written";
  if (body.contains("cover")) return "the body has a cover";
  if (document["time"]["integrator"] == "static") return "the problem is static";
  if (body.contains("membrane") && !body.contains("bending")) return "without bending a flat sheet has no modes";
  for (const auto& [name, constraint] : document["constraints"].items())
    if (constraint["type"] != "pin") return "of a modal body pins alone are constraints, and there is " + name;
  for (const auto& [name, load] : document["loads"].items()) {
    const std::string type = load["type"];
    if (type == "wind" || type == "end_moment" || (type == "pressure" && load["follows"] == true))
      return "the load " + name + " follows the body";
  }
  return "";
}

void make_modal(Json& document, int modes) {
  Json& body = document["bodies"].begin().value();
  body["model"] = "modal";
  body["modal"] = {{"modes", modes}};
  for (const auto& [name, constraint] : document["constraints"].items()) {
    if (!is_clamp(constraint)) continue;
    body["modal"]["clamp"] = constraint["select"];
    document["constraints"].erase(name);
    return;
  }
}

void add_modal(const Json& document, LeanLadder& ladder) {
  const std::string reason = why_no_modes(document);
  if (!reason.empty()) {
    refuse(ladder, "modal body", reason);
    return;
  }
  add(ladder, "modal body", {"in 40 modes", "in 20 modes", "in 10 modes"},
      [](Json& json, int level) { make_modal(json, 80 >> level); });
}

void add_integrator(const Json& document, LeanLadder& ladder) {
  const std::string name = "integrator", own = document["time"]["integrator"];
  if (own != "implicit_euler") {
    refuse(ladder, name, own == "static" ? "the problem is static" : own + " is of second order as it is");
    return;
  }
  if (document["time"]["steps"] < 20) {
    refuse(ladder, name, "there are too few steps");
    return;
  }
  add(ladder, name, {"BDF2 at twice the step"}, [](Json& json, int) {
    Json& time = json["time"];
    const int before = time["steps"], after = (before + 1) / 2;
    time["integrator"] = "bdf2";
    time["steps"] = after;
    time["step"] = time["step"].get<double>() * before / after;
  });
}

/// Removes a key of an object at a path, where it is there.
void add_removal(const Json& document, LeanLadder& ladder, const std::string& name, const std::string& pointer) {
  const Json::json_pointer place(pointer);
  if (!document.contains(place)) return;
  add(ladder, name, {"without " + name}, [place](Json& json, int) {
    if (json.contains(place)) json[place.parent_pointer()].erase(place.back());
  });
}

}  // namespace

void add_simpler_models(const Json& document, LeanLadder& ladder) {
  for (const auto& [name, body] : document["bodies"].items()) {
    add_cover(document, name, body, ladder);
    add_thick_shells(name, body, ladder);
    add_bending(name, body, ladder);
  }
  add_limits(document, ladder);
  add_modal(document, ladder);
  add_integrator(document, ladder);
}

void add_removals(const Json& document, LeanLadder& ladder) {
  for (const auto& [name, load] : document["loads"].items())
    add_removal(document, ladder, "load " + name, "/loads/" + name);
  for (const auto& [name, constraint] : document["constraints"].items()) {
    const std::string type = constraint["type"];
    if (type == "sphere" || type == "half_space")
      add_removal(document, ladder, "obstacle " + name, "/constraints/" + name);
  }
  if (document["gravity"] != Json({0.0, 0.0, 0.0})) add_removal(document, ladder, "gravity", "/gravity");
  for (const auto& [name, body] : document["bodies"].items()) {
    const std::string pointer = "/bodies/" + name;
    const auto damped = [](const Json& part) {
      return part["damping"].value("mass", 0.0) > 0 || part["damping"].value("stiffness", 0.0) > 0;
    };
    if (damped(body)) add_removal(document, ladder, "damping of " + name, pointer + "/damping");
    if (!body.contains("cover")) continue;
    if (damped(body["cover"]))
      add_removal(document, ladder, "damping of " + name + "/cover", pointer + "/cover/damping");
    add_removal(document, ladder, "foundation of " + name + "/cover", pointer + "/cover/foundation");
    add_removal(document, ladder, "imperfection of " + name + "/cover", pointer + "/cover/imperfection");
  }
}

}  // namespace taut
