#include "study/frame_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <exception>
#include <optional>
#include <set>
#include <tuple>

#include "constraints/obstacle.h"
#include "dynamics/modal/warped_position.h"
#include "files/obj.h"
#include "files/svg_picture.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

/// The step that NAME_00010.vtu belongs to, or nothing for other names.
std::optional<int> step_of(const fs::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t bar = stem.rfind('_');
  if (bar == stem.npos || stem.size() - bar < 6) return {};
  int step = 0;
  const char* end = stem.data() + stem.size();
  const auto [rest, error] = std::from_chars(stem.data() + bar + 1, end, step);
  if (error != std::errc() || rest != end || step < 0) return {};
  return step;
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::error_code missing;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder, missing)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string extension_of(scene::FrameFormat format) {
  switch (format) {
    case scene::FrameFormat::vtu:
      return ".vtu";
    case scene::FrameFormat::obj:
      return ".obj";
    case scene::FrameFormat::none:
      break;
  }
  return "";
}

std::vector<int> pinned_vertices(const Model& model) {
  std::set<int> vertices;
  for (const auto& constraint : model.constraints) {
    const auto* positions = dynamic_cast<const WarpedPosition*>(constraint.get());
    if (!positions) continue;
    for (const auto& held : positions->held()) vertices.insert(held.node);
  }
  for (const PinnedVariable& pin : model.pins) vertices.insert(pin.variable / 3);
  return {vertices.begin(), vertices.end()};
}

std::vector<Picture::Sphere> spheres_of(const Model& model) {
  std::vector<Picture::Sphere> spheres;
  for (const auto& constraint : model.constraints) {
    const auto* sphere = dynamic_cast<const SphereObstacle*>(constraint.get());
    if (sphere) spheres.push_back({sphere->center(), sphere->radius()});
  }
  return spheres;
}

/// From no stretch to the limit, so that what is at it stands out and pictures of one run compare; without a limit to
/// the largest value.
std::pair<double, double> colour_range(const std::vector<double>& stretches, std::optional<double> limit) {
  double high = limit.value_or(1.0);
  for (const double stretch : stretches) {
    if (!limit && std::isfinite(stretch)) high = std::max(high, stretch);
  }
  if (limit && high <= 1) return {high - 0.1, high};
  return {1.0, std::max(high, 1.001)};
}

}  // namespace

double time_of(const Scene& scene, int step) {
  if (scene.time.integrator == scene::Integrator::quasi_static) return static_cast<double>(step) / scene.time.steps;
  return step * scene.time.step;
}

std::string file_name(const std::string& scene_name) {
  std::string name = scene_name;
  for (char& c : name) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '.';
    if (!plain) c = '_';
  }
  return name.empty() || name[0] == '.' ? "_" + name : name;
}

void remove_frames_after(const fs::path& folder, int last_step) {
  constexpr std::array<std::string_view, 3> ours{".vtu", ".obj", ".svg"};
  for (const char* part : {"frames", "pictures", "modes"}) {
    for (const fs::path& file : files_in(folder / part)) {
      const bool is_ours = std::find(ours.begin(), ours.end(), file.extension().string()) != ours.end();
      if (is_ours && step_of(file).value_or(-1) > last_step) fs::remove(file);
    }
  }
  if (last_step >= 0) return;
  for (const fs::path& file : files_in(folder)) {
    if (file.extension() == ".pvd") fs::remove(file);
  }
}

FrameOutput::FrameOutput(const Scene& scene, const Model& model, fs::path folder, int last_step)
    : scene_(scene),
      model_(model),
      folder_(std::move(folder)),
      name_(file_name(scene.name)),
      extension_(extension_of(scene.output.format)),
      fields_(model, scene.output.stresses) {
  remove_frames_after(folder_, last_step);
  if (!extension_.empty()) fs::create_directories(folder_ / "frames");
  if (scene.output.pictures > 0) fs::create_directories(folder_ / "pictures");
  for (const fs::path& file : files_in(folder_ / "frames")) {
    const std::optional<int> step = step_of(file);
    const bool ours = step && file.extension() == extension_ && file.filename().string().starts_with(name_ + "_");
    if (ours) frames_.emplace_back(time_of(scene, *step), "frames/" + file.filename().string());
  }
}

bool FrameOutput::frame_is_due(int step) const {
  return !extension_.empty() && (step % scene_.output.every == 0 || step == scene_.time.steps);
}

bool FrameOutput::picture_is_due(int step) const {
  const long long pictures = scene_.output.pictures, steps = scene_.time.steps;
  // Picture i of 1 ... pictures is due at the step nearest to i steps / pictures.
  const long long nearest = (step * pictures + steps / 2) / steps;
  for (const long long i : {nearest - 1, nearest, nearest + 1}) {
    if (i >= 1 && i <= pictures && (2 * i * steps + pictures) / (2 * pictures) == step) return true;
  }
  return false;
}

void FrameOutput::write_frame(const State& state) {
  if (extension_.empty()) return;
  const double time = time_of(scene_, state.step);
  const std::string file = fmt::format("frames/{}_{:05}{}", name_, state.step, extension_);
  if (extension_ == ".vtu") {
    write_vtu(folder_ / file, fields_.frame(state, time));
  } else {
    write_obj(folder_ / file, model_.vertex_positions(state.positions), model_.triangles);
  }
  if (frames_.empty() || frames_.back().second != file) frames_.emplace_back(time, file);
}

void FrameOutput::write_modes(const State& state, const std::vector<NaturalMode>& modes) const {
  if (extension_ != ".vtu") return;
  fs::create_directories(folder_ / "modes");
  for (std::size_t k = 0; k < modes.size(); ++k) {
    double largest = 0;
    for (Index i = 0; i < modes[k].shape.size(); i += 3)
      largest = std::max(largest, modes[k].shape.segment<3>(i).norm());
    const Vector shape = modes[k].shape / (largest > 0 ? largest : 1);
    const Field displacement{"displacement", 3, {shape.begin(), shape.end()}};
    write_vtu(folder_ / fmt::format("modes/{}_mode_{:05}.vtu", name_, k + 1),
              {time_of(scene_, state.step), state.positions, model_.triangles, {displacement}, {}});
  }
}

std::string FrameOutput::write_picture(const State& state) const try {
  Picture picture;
  picture.positions = model_.vertex_positions(state.positions);
  picture.triangles = &model_.triangles;
  picture.triangle_values = fields_.largest_stretch(picture.positions);
  std::tie(picture.low, picture.high) = colour_range(picture.triangle_values, fields_.upper_limit());
  const bool is_static = scene_.time.integrator == scene::Integrator::quasi_static;
  picture.title =
      fmt::format("{}, {:.4g} {}", scene_.name, time_of(scene_, state.step), is_static ? "of the load" : "s");
  picture.value_name = "sigma max";
  picture.up = scene_.gravity.isZero() ? Vector3::Zero().eval() : Vector3(-scene_.gravity.normalized());
  if (scene_.output.view) picture.view_from = *scene_.output.view;
  picture.spheres = spheres_of(model_);
  picture.marked_vertices = pinned_vertices(model_);
  write_svg(folder_ / fmt::format("pictures/{}_{:05}.svg", name_, state.step), picture);
  return "";
} catch (const std::exception& error) {
  return fmt::format("no picture of step {}: {}", state.step, error.what());
}

void FrameOutput::write_index() const {
  if (extension_ == ".vtu") write_pvd(folder_ / (name_ + ".pvd"), frames_);
}

}  // namespace taut
