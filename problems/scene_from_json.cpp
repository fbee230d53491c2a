#include "problems/scene_from_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "problems/probe_from_json.h"
#include "problems/solver_from_json.h"

namespace taut {

namespace {

using namespace scene;

/// Turns a completed document into a Scene and checks what a schema cannot say.
class SceneReader : public ProbeReader {
 public:
  using ProbeReader::ProbeReader;

  Scene read(const Json& json, const std::string& default_name) {
    Scene result;
    result.name = json.value("name", default_name);
    result.description = json["description"];
    result.look_for = json["look_for"];
    result.source = source_;
    result.time = time(json["time"]);
    result.gravity = vector(json["gravity"]);
    for (const auto& [name, value] : json["bodies"].items()) {
      result.bodies.push_back(body(name, value));
      if (value["model"] == "wrinkled_shell") result.bodies.push_back(cover(result.bodies.back(), value));
    }
    bodies_ = &result.bodies;
    for (std::size_t k = 0; k < result.bodies.size(); ++k) read_modal(json["bodies"], static_cast<int>(k), result);
    for (const auto& [name, value] : json["constraints"].items()) result.constraints.push_back(constraint(name, value));
    for (const auto& [name, value] : json["loads"].items()) result.loads.push_back(load(name, value));
    result.solver = solver_from_json(json["solver"]);
    result.output = output(json["output"], result.time);
    check_frequencies(result);
    return result;
  }

 private:
  Time time(const Json& json) const {
    Time result;
    result.integrator = choose<Integrator>(json["integrator"], {{"implicit_euler", Integrator::implicit_euler},
                                                                {"bdf2", Integrator::bdf2},
                                                                {"generalised_alpha", Integrator::generalised_alpha},
                                                                {"newmark", Integrator::newmark},
                                                                {"static", Integrator::quasi_static}});
    result.steps = json["steps"];
    result.spectral_radius = json["spectral_radius"];
    result.beta = json["beta"];
    result.gamma = json["gamma"];
    result.halvings = json["halvings"];
    result.frequencies = json["frequencies"];
    if (result.integrator == Integrator::quasi_static) {
      result.step = 1.0 / result.steps;
    } else if (json.contains("step")) {
      result.step = json["step"];
    } else {
      missing("/time/step", "a number > 0, in s (only \"static\" goes without)");
    }
    return result;
  }

  void check_frequencies(const Scene& scene) const {
    if (scene.time.frequencies == 0) return;
    if (scene.time.integrator != Integrator::quasi_static)
      refuse("/time/frequencies", std::to_string(scene.time.frequencies), "0 unless the integrator is \"static\"");
    for (const scene::Constraint& constraint : scene.constraints) {
      if (!std::holds_alternative<Pin>(constraint.kind))
        refuse("/time/frequencies", std::to_string(scene.time.frequencies),
               "0 where a constraint is not a pin (" + constraint.name + ")");
    }
  }

  Body body(const std::string& name, const Json& json) const {
    const std::string pointer = "/bodies/" + name;
    Body result;
    result.name = name;
    if (json["mesh"].contains("grid"))
      result.mesh = grid(json["mesh"]["grid"]);
    else
      result.mesh = MeshFile{mesh_path(json["mesh"]["file"], pointer + "/mesh/file")};
    result.transform = transform(json["transform"], pointer + "/transform");
    result.rest = rest(json["rest"], pointer + "/rest");
    const bool wrinkled = json["model"] == "wrinkled_shell";
    if (json.contains("cover") != wrinkled)
      wrinkled ? missing(pointer + "/cover", "an object (\"model\" is \"wrinkled_shell\")")
               : refuse(pointer + "/cover", "\"cover\"", "none of it unless \"model\" is \"wrinkled_shell\"");
    const bool either = wrinkled || json["model"] == "modal";
    if (const auto* file = std::get_if<MeshFile>(&result.mesh); file && file->path.extension() == ".msh") {
      result.solid = solid(json, pointer);
      result.density = json["density"];
    } else if (json["model"] == "thick_shell" || (either && !json.contains("membrane") && !json.contains("bending"))) {
      result.shell = shell(json, pointer);
    } else {
      check_cloth(json, pointer);
      result.thickness = json["thickness"];
      result.density = json["density"];
    }
    cloth(json, result);
    result.initial_velocity = vector(json["initial_velocity"]);
    return result;
  }

  Solid solid(const Json& json, const std::string& pointer) const {
    if (json["model"] != "modal")
      refuse(pointer + "/model", json["model"].dump() + " with a mesh of tetrahedra", "\"modal\"");
    check_solid(json, pointer);
    return {json["material"]["young_modulus"], json["material"]["poisson_ratio"]};
  }

  /// Fills in Body::modal where the model says so, once bodies can be selected from.
  void read_modal(const Json& bodies, int index, Scene& scene) const {
    Body& body = scene.bodies[static_cast<std::size_t>(index)];
    if (body.cover) return;
    const Json& json = bodies[body.name];
    const std::string pointer = "/bodies/" + body.name;
    if (json["model"] != "modal") {
      if (json.contains("modal")) refuse(pointer + "/modal", "\"modal\"", "none of it unless \"model\" is \"modal\"");
      return;
    }
    if (scene.bodies.size() > 1)
      refuse(pointer + "/model", "\"modal\" beside other bodies", "a modal body is alone in its scene");
    if (scene.time.frequencies > 0)
      refuse("/time/frequencies", std::to_string(scene.time.frequencies),
             "0 for a modal body (taut modes prints them)");
    if (!json.contains("modal")) missing(pointer + "/modal", "an object (\"model\" is \"modal\")");
    const Json& part = json["modal"];
    Modal modal;
    modal.modes = part["modes"];
    if (part.contains("clamp")) modal.clamp = selection(part["clamp"], index, pointer + "/modal/clamp");
    modal.damping_ratio = part["damping_ratio"];
    modal.rotation = choose<WarpRotation>(
        part["rotation"],
        {{"exact", WarpRotation::exact}, {"predictor", WarpRotation::predictor}, {"none", WarpRotation::none}});
    if (part.contains("basis")) modal.basis = mesh_path(part["basis"], pointer + "/modal/basis");
    body.modal = modal;
  }

  /// What any sheet has.
  static void cloth(const Json& json, Body& result) {
    result.mass = choose<Mass>(json["mass"], {{"lumped", Mass::lumped}, {"consistent", Mass::consistent}});
    if (json.contains("membrane")) {
      const Json& membrane = json["membrane"];
      const MembraneLaw law = choose<MembraneLaw>(
          membrane["law"], {{"stvk", MembraneLaw::stvk}, {"neo_hookean", MembraneLaw::neo_hookean}});
      result.membrane = scene::Membrane{law, membrane["young_modulus"], membrane["poisson_ratio"]};
    }
    if (json.contains("bending")) result.bending = Bending{json["bending"]["stiffness"]};
    result.damping = {json["damping"]["mass"], json["damping"]["stiffness"]};
  }

  /// The fine membrane of a wrinkled shell, a body of its own.
  Body cover(const Body& shell, const Json& shell_json) const {
    const std::string pointer = "/bodies/" + shell.name + "/cover";
    const Json& json = shell_json["cover"];
    Body result;
    result.name = shell.name + "/cover";
    const Json& mesh = json["mesh"];
    if (mesh.contains("refine"))
      result.mesh = Refinement{mesh["refine"]};
    else if (mesh.contains("grid"))
      result.mesh = grid(mesh["grid"]);
    else
      result.mesh = MeshFile{mesh_path(mesh["file"], pointer + "/mesh/file")};
    result.transform = transform(json["transform"], pointer + "/transform");
    result.rest.scale = json["rest_scale"];
    result.thickness = json["thickness"];
    result.density = json["density"];
    cloth(json, result);
    result.initial_velocity = shell.initial_velocity;
    Cover cover;
    cover.surface = surface(json, shell, pointer, shell.shell ? Surface::top : Surface::mid, true);
    if (cover.surface == Surface::both) refuse(pointer + "/surface", "\"both\"", "top, bottom, mid");
    if (json.contains("foundation")) cover.foundation = json["foundation"]["stiffness"];
    if (json.contains("imperfection")) {
      cover.amplitude = json["imperfection"]["amplitude"];
      cover.seed = json["imperfection"]["seed"];
    }
    cover.farthest = optional_number(json, "farthest");
    result.cover = cover;
    return result;
  }

  static Grid grid(const Json& json) {
    return {{json["size"][0].get<double>(), json["size"][1].get<double>()},
            json["cells"][0],
            json["cells"][1],
            choose<Diagonals>(json["diagonals"], {{"alternating", Diagonals::alternating},
                                                  {"left", Diagonals::left},
                                                  {"right", Diagonals::right},
                                                  {"union_jack", Diagonals::union_jack}})};
  }

  Transform transform(const Json& json, const std::string& pointer) const {
    Transform result;
    result.scale = json["scale"];
    if (json.contains("rotate")) {
      result.axis = direction(json["rotate"]["axis"], pointer + "/rotate/axis");
      result.angle = radians(json["rotate"]["degrees"]);
    }
    result.translate = vector(json["translate"]);
    return result;
  }

  Rest rest(const Json& json, const std::string& pointer) const {
    Rest result;
    result.from = choose<RestShape>(
        json["from"], {{"initial", RestShape::initial}, {"uv", RestShape::uv}, {"mesh", RestShape::mesh}});
    result.scale = json["scale"];
    if (result.from == RestShape::mesh) {
      if (!json.contains("file"))
        throw InputError(source_, pointer + "/file", "missing, allowed: a mesh file (\"from\" is \"mesh\")");
      result.file = mesh_path(json["file"], pointer + "/file");
    } else if (json.contains("file")) {
      refuse(pointer + "/file", json["file"].dump(), "no file unless \"from\" is \"mesh\"");
    }
    return result;
  }

  scene::Constraint constraint(const std::string& name, const Json& json) const {
    const std::string pointer = "/constraints/" + name;
    scene::Constraint result;
    result.name = name;
    result.body = body_index(json, pointer);
    result.select = selection(json["select"], result.body, pointer + "/select");
    result.surface = surface_of(json, result.body, pointer, Surface::both);
    const std::string type = json["type"];
    if (type == "pin") {
      const std::string axes = json["axes"];
      const auto held = [&axes](char axis) { return axes.find(axis) != std::string::npos; };
      result.kind = Pin{held('x'), held('y'), held('z'), motion(json["motion"], pointer + "/motion")};
    } else if (type == "strain_limit") {
      result.kind = strain_limit(json, pointer);
    } else if (type == "half_space") {
      result.kind = HalfSpace{vector(json["point"]), direction(json["normal"], pointer + "/normal"),
                              motion(json["motion"], pointer + "/motion")};
    } else {
      result.kind = Sphere{vector(json["center"]), json["radius"], motion(json["motion"], pointer + "/motion")};
    }
    return result;
  }

  Surface surface_of(const Json& json, int body, const std::string& pointer, Surface otherwise) const {
    return surface(json, (*bodies_)[static_cast<std::size_t>(body)], pointer, otherwise);
  }

  StrainLimit strain_limit(const Json& json, const std::string& pointer) const {
    if (json.value("surface", "") == "mid") refuse(pointer + "/surface", "\"mid\"", "both, bottom, top");
    StrainLimit result;
    result.form = choose<LimitForm>(json["form"],
                                    {{"matrix", LimitForm::matrix}, {"singular_values", LimitForm::singular_values}});
    result.min = optional_number(json, "min");
    result.max = optional_number(json, "max");
    if (!result.min && !result.max)
      throw InputError(source_, pointer, "found neither \"min\" nor \"max\", allowed: at least one of them");
    if (result.min && result.max && *result.min > *result.max)
      refuse(pointer + "/min", json["min"].dump(), "a number <= max, which is " + json["max"].dump());
    return result;
  }

  Motion motion(const Json& json, const std::string& pointer) const {
    Motion result;
    result.velocity = vector(json["velocity"]);
    result.point = vector(json["point"]);
    result.angular_velocity = radians(json["degrees_per_second"]);
    bool rotates = result.angular_velocity != 0;
    const Json& keyframes = json["keyframes"];
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
      const Json& frame = keyframes[i];
      result.keyframes.push_back({frame["time"], vector(frame["translation"]), radians(frame["degrees"])});
      rotates = rotates || result.keyframes.back().angle != 0;
      if (i > 0 && !(keyframes[i - 1]["time"] < frame["time"]))
        refuse(fmt::format("{}/keyframes/{}/time", pointer, i), frame["time"].dump(),
               "a number > the previous keyframe's, " + keyframes[i - 1]["time"].dump());
    }
    if (json.contains("axis"))
      result.axis = direction(json["axis"], pointer + "/axis");
    else if (rotates)
      throw InputError(source_, pointer + "/axis", "missing, allowed: a vector that is not zero (there is a rotation)");
    return result;
  }

  Load load(const std::string& name, const Json& json) const {
    const std::string pointer = "/loads/" + name;
    Load result;
    result.name = name;
    result.body = body_index(json, pointer);
    const std::string type = json["type"];
    result.surface = surface_of(json, result.body, pointer, type == "pressure" ? Surface::top : Surface::both);
    if (type == "point_load") {
      result.kind = PointLoad{selection(json["select"], result.body, pointer + "/select"), vector(json["force"])};
    } else if (type == "edge_load") {
      result.kind =
          EdgeLoad{selection(json["select"], result.body, pointer + "/select"), vector(json["force_per_length"])};
    } else if (type == "pressure") {
      result.kind = Pressure{json["pressure"], json["follows"]};
    } else if (type == "surface_load") {
      result.kind = surface_load(json);
    } else if (type == "end_moment") {
      result.kind = end_moment(json, result.body, pointer);
    } else {
      result.kind = Wind{vector(json["velocity"]), json["air_density"], json["drag"]};
    }
    return result;
  }

  static SurfaceLoad surface_load(const Json& json) {
    SurfaceLoad result{vector(json["force_per_area"]), {}};
    for (const Json& wave : json["half_waves"]) result.half_waves.push_back(vector(wave));
    return result;
  }

  scene::EndMoment end_moment(const Json& json, int body, const std::string& pointer) const {
    const Body& on = (*bodies_)[static_cast<std::size_t>(body)];
    if (!on.shell) refuse(pointer + "/body", "\"" + on.name + "\", which is cloth", "a thick shell");
    direction(json["moment_per_length"], pointer + "/moment_per_length");  // not zero
    return {selection(json["select"], body, pointer + "/select"), vector(json["moment_per_length"])};
  }

  Output output(const Json& json, const Time& time) const {
    Output result;
    result.format = choose<FrameFormat>(
        json["format"], {{"vtu", FrameFormat::vtu}, {"obj", FrameFormat::obj}, {"none", FrameFormat::none}});
    result.every = json["every"];
    result.stresses = json["stresses"];
    result.pictures = json["pictures"];
    if (json.contains("view")) result.view = direction(json["view"], "/output/view");
    for (const auto& [name, value] : json["probes"].items()) result.probes.push_back(probe(name, value, time));
    return result;
  }
};

}  // namespace

Scene scene_from_json(const nlohmann::json& document, const std::filesystem::path& folder, const std::string& source,
                      const std::string& default_name) {
  return SceneReader(folder, source).read(document, default_name);
}

}  // namespace taut
