#include "problems/scene.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace taut::scene {

namespace {

/// The keyframes at a time: linear between, constant outside.
Keyframe interpolate(const std::vector<Keyframe>& keyframes, double time) {
  if (keyframes.empty()) return {};
  const auto next = std::upper_bound(keyframes.begin(), keyframes.end(), time,
                                     [](double t, const Keyframe& frame) { return t < frame.time; });
  if (next == keyframes.begin()) return keyframes.front();
  if (next == keyframes.end()) return keyframes.back();
  const Keyframe& a = *std::prev(next);
  const Keyframe& b = *next;
  const double s = (time - a.time) / (b.time - a.time);
  return {time, (1 - s) * a.translation + s * b.translation, (1 - s) * a.angle + s * b.angle};
}

Matrix3 rotation(double angle, const Vector3& axis) { return Eigen::AngleAxisd(angle, axis).toRotationMatrix(); }

}  // namespace

Vector3 Transform::operator()(const Vector3& x) const { return rotation(angle, axis) * (scale * x) + translate; }

bool Motion::at_rest() const {
  const auto still = [](const Keyframe& frame) { return frame.translation.isZero(0) && frame.angle == 0; };
  return velocity.isZero(0) && angular_velocity == 0 && std::all_of(keyframes.begin(), keyframes.end(), still);
}

Vector3 Motion::position(const Vector3& x, double time) const {
  const Keyframe frame = interpolate(keyframes, time);
  const Vector3 shift = frame.translation + time * velocity;
  const double angle = frame.angle + time * angular_velocity;
  // Without a rotation x itself is shifted: a pin at rest stays where it is to the last bit.
  if (angle == 0) return x + shift;
  return point + rotation(angle, axis) * (x - point) + shift;
}

Vector3 Motion::direction(const Vector3& d, double time) const {
  return rotation(interpolate(keyframes, time).angle + time * angular_velocity, axis) * d;
}

}  // namespace taut::scene
