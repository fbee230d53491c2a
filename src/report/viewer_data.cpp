#include "report/viewer_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "constraints/obstacle.h"
#include "files/atomic_file.h"
#include "files/packed_text.h"
#include "problems/build.h"
#include "report/triangle_fields.h"
#include "study/frame_files.h"
#include "study/frame_output.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::json;
static_assert(std::endian::native == std::endian::little, "the page reads the arrays as they are");

template <class Number>
Json packed(const std::vector<Number>& values) {
  return {{"type", fmt::format("uint{}", 8 * sizeof(Number))}, {"data", packed_text(std::as_bytes(std::span(values)))}};
}

/// Every frame but the first as the difference to the one before, which a compressor makes small.
void subtract_frames(std::vector<std::uint16_t>& values, std::size_t count) {
  for (std::size_t i = values.size(); i-- > count;)
    values[i] = static_cast<std::uint16_t>(values[i] - values[i - count]);
}

std::vector<ViewerFrame> frames_of(const fs::path& folder, const Scene& scene) {
  std::vector<ViewerFrame> frames;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(folder / "frames", missing)) {
    const fs::path& file = entry.path();
    const bool ours = file.filename().string().starts_with(file_name(scene.name) + "_") &&
                      (file.extension() == ".vtu" || file.extension() == ".obj");
    if (const auto number = frame_number(file); ours && number)
      frames.push_back({*number, [file] { return read_frame(file); }, file.string()});
  }
  std::sort(frames.begin(), frames.end(), [](const auto& a, const auto& b) { return a.step < b.step; });
  return frames;
}

/// At most `count` of the frames, evenly, the first and the last among them.
std::vector<ViewerFrame> spread(const std::vector<ViewerFrame>& frames, std::size_t count) {
  if (frames.size() <= count) return frames;
  std::vector<ViewerFrame> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(frames[i * (frames.size() - 1) / (count - 1)]);
  return chosen;
}

/// How far each triangle's vertices are from other positions, the largest; NaN where there are none.
std::vector<double> distances(const Model& model, const Vector& positions, const std::optional<Vector>& other) {
  std::vector<double> values(model.triangles.size(), std::numeric_limits<double>::quiet_NaN());
  if (!other || other->size() != positions.size()) return values;
  for (std::size_t t = 0; t < values.size(); ++t) {
    values[t] = 0;
    for (const int vertex : model.triangles[t])
      values[t] = std::max(values[t], (positions.segment<3>(3 * vertex) - other->segment<3>(3 * vertex)).norm());
  }
  return values;
}

/// The last picture of the run, packed.
Json picture_of(const fs::path& folder) {
  std::optional<fs::path> last;
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(folder / "pictures", missing)) {
    if (entry.path().extension() == ".svg" && (!last || entry.path() > *last)) last = entry.path();
  }
  if (!last) return nullptr;
  const std::string svg = read_bytes(*last);
  return packed_text(std::as_bytes(std::span(svg)));
}

Json layers_of(const Model& model) {
  Json layers = Json::array();
  for (const BodyRange& body : model.bodies) {
    const int sides = body.levels > 1 ? 2 : 1, count = body.triangles / sides;
    for (int side = 0; side < sides; ++side) {
      layers.push_back({{"name", sides == 1 ? body.name : body.name + (side == 0 ? ", bottom" : ", top")},
                        {"body", body.name},
                        {"first", body.first_triangle + side * count},
                        {"count", count},
                        {"offset", body.first_triangle}});
    }
  }
  return layers;
}

Json pins_of(const Model& model) {
  std::set<int> vertices;
  if (!model.modal) {
    for (const PinnedVariable& pin : model.pins) vertices.insert(pin.variable / 3);
  }
  return vertices;
}

Json vector_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

/// Up and the direction to the eye, as in the pictures (files/svg_picture.h).
void add_view(const Scene& scene, Json& data) {
  const Vector3 up = scene.gravity.isZero() ? Vector3::UnitZ().eval() : Vector3(-scene.gravity.normalized());
  const Vector3 sideways = std::abs(up.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
  const Vector3 right = (sideways - sideways.dot(up) * up).normalized();
  data["up"] = vector_json(up);
  data["view"] = vector_json(scene.output.view.value_or(0.5 * right + right.cross(up) + 0.5 * up));
}

/// Positions of all frames as fractions of the box around them.
void add_positions(const std::vector<Vector>& frames, Json& data) {
  Vector3 low = frames.front().head<3>(), high = low;
  for (const Vector& frame : frames) {
    const auto points = frame.reshaped(3, frame.size() / 3);
    low = low.cwiseMin(points.rowwise().minCoeff());
    high = high.cwiseMax(points.rowwise().maxCoeff());
  }
  const Vector3 size = (high - low).unaryExpr([](double length) { return length > 0 ? length : 1; });
  std::vector<std::uint16_t> values;
  for (const Vector& frame : frames) {
    for (Index i = 0; i < frame.size(); ++i) {
      values.push_back(static_cast<std::uint16_t>(std::lround(65535 * (frame[i] - low[i % 3]) / size[i % 3])));
    }
  }
  subtract_frames(values, static_cast<std::size_t>(frames.front().size()));
  data["box"] = {{"low", vector_json(low)}, {"high", vector_json(high)}};
  data["positions"] = packed(values);
}

Json field_json(const TriangleField& field) {
  constexpr std::uint16_t none = 65535;
  std::vector<std::uint16_t> values;
  const auto [least, most] = field.extremes();
  const double range = most > least ? most - least : 1;
  for (const auto& frame : field.frames) {
    for (const double value : frame) {
      values.push_back(
          std::isfinite(value) ? static_cast<std::uint16_t>(std::lround((none - 1) * (value - least) / range)) : none);
    }
  }
  subtract_frames(values, field.frames.front().size());
  return {{"id", field.id},
          {"title", field.title},
          {"unit", field.unit},
          {"low", field.low.value_or(least)},
          {"high", field.high.value_or(most)},
          {"least", least},
          {"most", most},
          {"values", packed(values)}};
}

/// Where spheres are in each frame; the model's obstacles are moved.
class SphereTracks {
 public:
  explicit SphereTracks(const Model& model) {
    for (const auto& constraint : model.constraints) {
      if (const auto* sphere = dynamic_cast<const SphereObstacle*>(constraint.get())) spheres_.push_back({sphere, {}});
    }
  }
  void take() {
    for (auto& [sphere, centers] : spheres_) centers.push_back(vector_json(sphere->center()));
  }
  Json json() const {
    Json list = Json::array();
    for (const auto& [sphere, centers] : spheres_) list.push_back({{"radius", sphere->radius()}, {"centers", centers}});
    return list;
  }

 private:
  std::vector<std::pair<const SphereObstacle*, std::vector<Json>>> spheres_;
};

std::string note_on(std::size_t shown, std::size_t all, const Model& model) {
  std::string note = shown == all ? fmt::format("All {} frames of the run", all)
                                  : fmt::format("{} of the run's {} frames, evenly spread", shown, all);
  note +=
      fmt::format(": {} triangles, positions and values rounded to 16 bits of their range.", model.triangles.size());
  const auto planes = std::count_if(model.constraints.begin(), model.constraints.end(), [](const auto& constraint) {
    return dynamic_cast<const HalfSpace*>(constraint.get()) != nullptr;
  });
  return planes > 0 ? note + " Half-spaces are not drawn." : note;
}

}  // namespace

Json viewer_data(const fs::path& folder, const Scene& scene, const ViewerLimits& limits) {
  const std::vector<ViewerFrame> frames = frames_of(folder, scene);
  if (frames.empty()) return nullptr;
  Json data = viewer_data(scene, frames, {}, limits);
  data["picture"] = picture_of(folder);
  return data;
}

Json viewer_data(const Scene& scene, const std::vector<ViewerFrame>& all, const std::vector<OtherPositions>& others,
                 const ViewerLimits& limits) {
  const auto model = build_model(scene);
  const Index vertices = model->start().size() / 3;
  const long long most =
      std::max(2LL, std::min<long long>(limits.frames, limits.vertices / std::max<Index>(1, vertices)));
  const std::vector<ViewerFrame> chosen = spread(all, static_cast<std::size_t>(most));

  TriangleFields fields(*model);
  std::vector<TriangleField> apart;
  for (const OtherPositions& other : others)
    apart.push_back({"distance_" + other.name, "distance to " + other.name, "m", 0.0, {}, {}});
  SphereTracks spheres(*model);
  std::vector<Vector> positions;
  Json data{{"vertices", vertices}, {"frames", Json::array()}, {"picture", nullptr}};
  for (const ViewerFrame& one : chosen) {
    const Frame frame = one.read();
    if (frame.positions.size() != 3 * vertices || !frame.positions.allFinite())
      throw FileError(one.source,
                      fmt::format("does not hold the {} vertices of the scene as finite numbers", vertices));
    const double time = time_of(scene, one.step);
    for (const auto& mover : model->movers) mover(time);
    fields.take(frame);
    for (std::size_t k = 0; k < others.size(); ++k)
      apart[k].frames.push_back(distances(*model, frame.positions, others[k].at(one.step)));
    spheres.take();
    positions.push_back(frame.positions);
    data["frames"].push_back({{"step", one.step}, {"time", time}});
  }
  add_positions(positions, data);
  std::vector<std::uint32_t> corners;
  for (const Triangle& triangle : model->triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  data["triangles"] = packed(corners);
  data["fields"] = Json::array();
  for (const TriangleField& field : fields.fields()) data["fields"].push_back(field_json(field));
  for (const TriangleField& field : apart) {
    if (field.extremes().second > 0) data["fields"].push_back(field_json(field));
  }
  data["worst"] = Json::array();
  for (const WorstPlace& worst : fields.worst()) {
    data["worst"].push_back({{"field", worst.field},
                             {"what", worst.what},
                             {"unit", worst.unit},
                             {"element", worst.element},
                             {"value", worst.value},
                             {"frame", worst.frame},
                             {"triangles", worst.triangles}});
  }
  data["layers"] = layers_of(*model);
  data["pins"] = pins_of(*model);
  data["spheres"] = spheres.json();
  data["time_unit"] = scene.time.integrator == scene::Integrator::quasi_static ? "of the load" : "s";
  data["note"] = note_on(chosen.size(), all.size(), *model);
  add_view(scene, data);
  return data;
}

}  // namespace taut
