#include "problems/shell_from_json.h"

#include <nlohmann/json.hpp>
#include <numeric>

#include "problems/schema.h"

namespace taut {
namespace {

using namespace scene;

int number_of_prisms(const std::vector<Layer>& layers) {
  return std::accumulate(layers.begin(), layers.end(), 0,
                         [](int sum, const Layer& layer) { return sum + layer.prisms; });
}

/// A section "shell" that says nothing, completed as the reader of files has done with every other.
const nlohmann::json& default_shell() {
  static const nlohmann::json completed = [] {
    const auto schema = nlohmann::ordered_json::parse(problem_schema());
    nlohmann::ordered_json shell = nlohmann::ordered_json::object();
    complete(shell, {{"$ref", "#/definitions/shell"}, {"definitions", schema["definitions"]}}, "");
    return nlohmann::json(shell);
  }();
  return completed;
}

}  // namespace

void ShellReader::refuse_keys(const Json& body, const std::string& pointer, std::initializer_list<const char*> keys,
                              const std::string& allowed) const {
  for (const char* key : keys)
    if (body.contains(key)) refuse(pointer + "/" + key, std::string("\"") + key + "\"", allowed);
}

void ShellReader::check_cloth(const Json& body, const std::string& pointer) const {
  refuse_keys(body, pointer, {"top", "material", "layers", "vertex_thickness"},
              "none of it where \"model\" is \"cloth\"");
  if (body["shell"] != default_shell())
    refuse(pointer + "/shell", "\"shell\"", "none of it, or its defaults, where \"model\" is \"cloth\"");
  if (!body.contains("thickness")) missing(pointer + "/thickness", "a number > 0, in m");
  if (!body.contains("density")) missing(pointer + "/density", "a number > 0, in kg/m3");
}

void ShellReader::check_solid(const Json& body, const std::string& pointer) const {
  refuse_keys(body, pointer, {"thickness", "vertex_thickness", "top", "layers", "membrane", "bending"},
              "none of it with a mesh of tetrahedra");
  if (body["shell"] != default_shell())
    refuse(pointer + "/shell", "\"shell\"", "none of it, or its defaults, with a mesh of tetrahedra");
  if (!body.contains("density")) missing(pointer + "/density", "a number > 0, in kg/m3");
  if (!body.contains("material")) missing(pointer + "/material", "an object");
  if (!body["material"].contains("young_modulus"))
    refuse(pointer + "/material", "a ply", "an isotropic material with a mesh of tetrahedra");
}

ThickShell ShellReader::shell(const Json& body, const std::string& pointer) const {
  refuse_keys(body, pointer, {"membrane", "bending"}, "none of it where \"model\" is \"thick_shell\"");
  if (body["rest"]["from"] != "initial" || body["rest"]["scale"] != 1.0)
    refuse(pointer + "/rest", body["rest"].dump(), "the initial positions, which are a thick shell's rest shape");
  ThickShell result;
  if (body.contains("top")) result.top = mesh_path(body["top"]["file"], pointer + "/top/file");
  result.layers = layers(body, pointer);
  if (body.contains("vertex_thickness")) {
    refuse_keys(body, pointer, {"thickness", "top"}, "either \"vertex_thickness\" or this");
    const Json& thickness = body["vertex_thickness"];
    if (thickness.contains("values")) {
      result.vertex_thickness = thickness["values"].get<std::vector<double>>();
    } else if (body["mesh"].contains("file")) {
      result.thickness_property = thickness["property"];
    } else {
      refuse(pointer + "/vertex_thickness", "a property of a grid", "\"values\", or a mesh file with that property");
    }
  }
  const Json& shell = body["shell"];
  result.options = options(shell, pointer + "/shell", number_of_prisms(result.layers));
  result.direction = direction(shell["direction"], pointer + "/shell/direction");
  return result;
}

std::vector<Layer> ShellReader::layers(const Json& body, const std::string& pointer) const {
  std::vector<Layer> result;
  if (body.contains("layers")) {
    refuse_keys(body, pointer, {"thickness", "density", "material"}, "either \"layers\" or this");
    for (std::size_t i = 0; i < body["layers"].size(); ++i)
      result.push_back(layer(body["layers"][i], pointer + "/layers/" + std::to_string(i)));
    return result;
  }
  if (body.contains("top"))
    refuse_keys(body, pointer, {"thickness"}, "either \"top\" or this");
  else if (!body.contains("thickness") && !body.contains("vertex_thickness"))
    missing(pointer + "/thickness", "a number > 0, in m (or \"layers\", \"top\" or \"vertex_thickness\")");
  if (!body.contains("density")) missing(pointer + "/density", "a number > 0, in kg/m3 (or \"layers\")");
  if (!body.contains("material")) missing(pointer + "/material", "an object (or \"layers\")");
  result.push_back(layer(body, pointer));
  return result;
}

Layer ShellReader::layer(const Json& json, const std::string& pointer) const {
  Layer result;
  result.thickness = json.value("thickness", 1.0);  // a share: "top" or "vertex_thickness" say how much
  result.density = json["density"];
  result.prisms = json.value("prisms", 1);
  const Json& material = json["material"];
  result.has_fibres = material.contains("E_L");
  try {
    if (result.has_fibres) {
      result.material = SolidMaterial::ply(
          {material["E_L"], material["E_T"], material["G_LT"], material["G_TT"], material["nu_LT"], material["nu_TT"]});
      result.fibre_angle = radians(material["fibre_degrees"]);
    } else {
      const SolidLaw law =
          choose<SolidLaw>(material["law"], {{"stvk", SolidLaw::stvk}, {"neo_hookean", SolidLaw::neo_hookean}});
      result.material = SolidMaterial::isotropic(law, material["young_modulus"], material["poisson_ratio"]);
    }
  } catch (const std::invalid_argument&) {
    refuse(pointer + "/material", "moduli whose elasticity is not positive definite",
           "those of an elastic solid, such as nu_LT^2 < E_L/E_T and |nu_TT| < 1");
  }
  return result;
}

PrismShellOptions ShellReader::options(const Json& json, const std::string& pointer, int prisms) const {
  PrismShellOptions result;
  result.element = choose<PrismElement>(
      json["element"], {{"assumed_strain", PrismElement::assumed_strain}, {"plain", PrismElement::plain}});
  result.points_in_plane = json["points_in_plane"];
  if (result.points_in_plane != 1 && result.points_in_plane != 3 && result.points_in_plane != 6)
    refuse(pointer + "/points_in_plane", json["points_in_plane"].dump(), "1, 3, 6");
  result.points_in_thickness = json["points_in_thickness"];
  result.shear_stabilisation = json["shear_stabilisation"];
  result.shear_correction = optional_number(json, "shear_correction").value_or(prisms == 1 ? 5.0 / 6 : 1.0);
  if (result.element == PrismElement::plain) {
    if (json.contains("shear_correction"))
      refuse(pointer + "/shear_correction", json["shear_correction"].dump(), "none of it for the plain element");
    if (result.shear_stabilisation != 0)
      refuse(pointer + "/shear_stabilisation", json["shear_stabilisation"].dump(), "0 for the plain element");
    result.shear_correction = 1;
    result.enhanced_thickness = false;
  } else {
    result.enhanced_thickness = json["enhanced_thickness"];
  }
  return result;
}

Surface ShellReader::surface(const Json& json, const Body& body, const std::string& pointer, Surface otherwise,
                             bool inside_prisms) const {
  if (!json.contains("surface")) return otherwise;
  const std::string name = json["surface"];
  if (!body.shell)
    refuse(pointer + "/surface", "\"" + name + "\" of " + body.name + ", which is cloth",
           "surfaces of thick shells only");
  const Surface surface = choose<Surface>(
      json["surface"],
      {{"both", Surface::both}, {"bottom", Surface::bottom}, {"top", Surface::top}, {"mid", Surface::mid}});
  const int prisms = number_of_prisms(body.shell->layers);
  if (surface == Surface::mid && prisms % 2 != 0 && !inside_prisms)
    refuse(pointer + "/surface",
           "\"mid\" of " + body.name + ", which has " + std::to_string(prisms) + " prisms through its thickness",
           "both, bottom, top (no node is in the middle of an odd number of prisms)");
  return surface;
}

}  // namespace taut
