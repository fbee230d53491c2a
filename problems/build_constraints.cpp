#include <algorithm>
#include <limits>
#include <map>

#include "constraints/obstacle.h"
#include "constraints/strain_limit.h"
#include "problems/build_parts.h"

namespace taut {
namespace {

std::string pointer_to(const scene::Constraint& constraint) { return "/constraints/" + constraint.name; }

bool same_motion(const scene::Motion& a, const scene::Motion& b) {
  if (a.at_rest() && b.at_rest()) return true;
  const auto same_frame = [](const scene::Keyframe& p, const scene::Keyframe& q) {
    return p.time == q.time && p.translation == q.translation && p.angle == q.angle;
  };
  return a.axis == b.axis && a.point == b.point && a.velocity == b.velocity &&
         a.angular_velocity == b.angular_velocity &&
         std::equal(a.keyframes.begin(), a.keyframes.end(), b.keyframes.begin(), b.keyframes.end(), same_frame);
}

/// Which pin holds each variable: the union of all pins.
class PinCollector {
 public:
  PinCollector(const Scene& scene, const Vector& positions) : scene_(scene), positions_(positions) {}

  void add(const scene::Constraint& constraint, const scene::Pin& pin, const BodyShape& shape) {
    const bool held[3] = {pin.x, pin.y, pin.z};
    for (const int vertex : selected_vertices(scene_, shape, constraint.select, pointer_to(constraint) + "/select")) {
      for (const int node : shape.nodes_at(vertex, constraint.surface)) {
        for (int axis = 0; axis < 3; ++axis) {
          if (held[axis]) hold(3 * node + axis, {&constraint, &pin.motion}, vertex, shape);
        }
      }
    }
  }

  /// In ascending order of variables.
  std::vector<PinnedVariable> pins() const {
    std::vector<PinnedVariable> pins;
    for (const auto& [variable, holder] : holders_) {
      const Vector3 start = positions_.segment<3>(variable - variable % 3);
      pins.push_back({variable, [motion = *holder.motion, start, axis = variable % 3](double time) {
                        return motion.position(start, time)[axis];
                      }});
    }
    return pins;
  }

 private:
  struct Holder {
    const scene::Constraint* constraint;
    const scene::Motion* motion;
  };
  void hold(int variable, const Holder& holder, int vertex, const BodyShape& shape) {
    const auto [at, is_new] = holders_.try_emplace(variable, holder);
    if (is_new || same_motion(*at->second.motion, *holder.motion)) return;
    throw InputError(scene_.source, pointer_to(*holder.constraint),
                     std::string("found another motion than that of ") + at->second.constraint->name + " for the " +
                         "xyz"[variable % 3] + " of vertex " + std::to_string(vertex) + " of " + shape.name +
                         ", allowed: one motion for each coordinate");
  }

  const Scene& scene_;
  const Vector& positions_;
  std::map<int, Holder> holders_;
};

/// The triangles all of whose vertices are selected.
StrainLimitTriangles limited_triangles(const Scene& scene, const scene::Constraint& constraint,
                                       const BodyShape& shape) {
  const std::string pointer = pointer_to(constraint) + "/select";
  const std::vector<int> selected = selected_vertices(scene, shape, constraint.select, pointer);
  StrainLimitTriangles limit;
  limit.constraint = constraint.name;
  limit.body = shape.name;
  const std::size_t triangles = shape.mesh.triangles.size();
  const std::size_t begin = shape.layered && constraint.surface == scene::Surface::top ? triangles : 0;
  const std::size_t end = constraint.surface == scene::Surface::bottom ? triangles : shape.rest.size();
  for (std::size_t t = begin; t < end; ++t) {
    const Triangle& triangle = shape.mesh.triangles[t % triangles];
    if (!std::all_of(triangle.begin(), triangle.end(),
                     [&](int v) { return std::binary_search(selected.begin(), selected.end(), v); }))
      continue;
    limit.triangles.push_back(shape.rest[t]);
    limit.ids.push_back(static_cast<int>(t));
  }
  if (limit.triangles.empty()) {
    throw InputError(
        scene.source, pointer,
        "found " + std::to_string(selected.size()) + " vertices of " + shape.name +
            " and no triangle among them, allowed: a selection with all three vertices of at least one triangle");
  }
  return limit;
}

std::unique_ptr<Constraint> strain_limit(StrainLimitTriangles triangles, const scene::StrainLimit& limit) {
  triangles.min = limit.min.value_or(0.0);
  triangles.max = limit.max.value_or(std::numeric_limits<double>::infinity());
  if (limit.form == scene::LimitForm::matrix) return std::make_unique<MatrixStrainLimit>(std::move(triangles));
  return std::make_unique<SingularValueStrainLimit>(std::move(triangles));
}

/// Puts an obstacle where it is at time 0 and, if it moves, leaves a mover with the model. `place(time)` holds the
/// obstacle by pointer.
void add_obstacle(std::unique_ptr<Constraint> obstacle, const scene::Motion& motion, std::function<void(double)> place,
                  Model& model) {
  place(0);
  if (!motion.at_rest()) model.movers.push_back(std::move(place));
  model.constraints.push_back(std::move(obstacle));
}

}  // namespace

double scene_size(const Vector& positions) {
  const Eigen::Map<const Eigen::Matrix3Xd> points(positions.data(), 3, positions.size() / 3);
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

void add_constraints(const Scene& scene, const std::vector<BodyShape>& shapes, Model& model) {
  const double size = scene_size(model.positions);
  PinCollector pins(scene, model.positions);
  for (const scene::Constraint& constraint : scene.constraints) {
    const BodyShape& shape = shapes[constraint.body];
    const auto scene_nodes = [&] {
      std::vector<int> nodes;
      for (const int vertex : selected_vertices(scene, shape, constraint.select, pointer_to(constraint) + "/select")) {
        for (const int node : shape.nodes_at(vertex, scene::Surface::both)) nodes.push_back(node);
      }
      return nodes;
    };
    if (const auto* pin = std::get_if<scene::Pin>(&constraint.kind)) {
      pins.add(constraint, *pin, shape);
    } else if (const auto* limit = std::get_if<scene::StrainLimit>(&constraint.kind)) {
      model.constraints.push_back(strain_limit(limited_triangles(scene, constraint, shape), *limit));
    } else if (const auto* half = std::get_if<scene::HalfSpace>(&constraint.kind)) {
      auto obstacle = std::make_unique<HalfSpace>(constraint.name, shape.name, scene_nodes(), shape.first_node, size);
      const auto place = [at = obstacle.get(), half = *half](double time) {
        at->place(half.motion.position(half.point, time), half.motion.direction(half.normal, time));
      };
      add_obstacle(std::move(obstacle), half->motion, place, model);
    } else {
      const auto& sphere = std::get<scene::Sphere>(constraint.kind);
      auto obstacle = std::make_unique<SphereObstacle>(constraint.name, shape.name, scene_nodes(), shape.first_node,
                                                       size, sphere.radius);
      const auto place = [at = obstacle.get(), sphere](double time) {
        at->place(sphere.motion.position(sphere.center, time));
      };
      add_obstacle(std::move(obstacle), sphere.motion, place, model);
    }
  }
  model.pins = pins.pins();
}

}  // namespace taut
