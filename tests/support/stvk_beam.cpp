#include "support/stvk_beam.h"

#include <cmath>
#include <functional>

namespace taut {
namespace {

/// (a, b, theta', delta) of a section.
using Section = Eigen::Vector4d;

/// Derivatives of the section's energy per length.
Section stresses(const StvkBeam& beam, const Section& s) {
  const double a = s[0], b = s[1], delta = s[3], bend = delta * s[2];
  const double t = beam.thickness, i2 = t * t * t / 12, i4 = std::pow(t, 5) / 80, c = a * a + b * b - 1;
  // Integral of (2 E11)^2 over the height: c^2 t + (4 a^2 + 2 c) K^2 i2 + K^4 i4.
  const double by_c = 2 * c * t + 2 * bend * bend * i2;
  const double by_bend = 2 * (4 * a * a + 2 * c) * bend * i2 + 4 * bend * bend * bend * i4;
  const double e = beam.young / 8, shear = beam.shear_correction * beam.young / 2 * t;
  return {e * (by_c * 2 * a + 8 * a * bend * bend * i2), e * by_c * 2 * b + shear * b * delta * delta,
          e * by_bend * delta,
          e * by_bend * s[2] + shear * b * b * delta + beam.young * t / 2 * (delta * delta - 1) * delta};
}

/// The section with these forces along a and b and this moment, from a guess, by Newton's method with differences.
Section section_under(const StvkBeam& beam, const Eigen::Vector3d& loads, Section guess) {
  const Eigen::Vector4d wanted(loads[0], loads[1], loads[2], 0);
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Eigen::Vector4d rest = stresses(beam, guess) - wanted;
    Eigen::Matrix4d slope;
    for (int j = 0; j < 4; ++j) {
      const Section step = 1e-6 * Section::Unit(j);
      slope.col(j) = (stresses(beam, guess + step) - stresses(beam, guess - step)) / 2e-6;
    }
    const Section change = slope.partialPivLu().solve(rest);
    guess -= change;
    if (change.norm() < 1e-13) break;
  }
  return guess;
}

/// Runs from the clamp with `moment` there under an upward `force`; returns (x, z, angle, moment) at the tip.
Eigen::Vector4d shoot(const StvkBeam& beam, double moment, double force) {
  Section section(1, 0, 0, 1);
  const auto rate = [&](const Eigen::Vector4d& state) -> Eigen::Vector4d {
    const double cosine = std::cos(state[2]), sine = std::sin(state[2]);
    section = section_under(beam, {force * sine, force * cosine, state[3]}, section);
    const double x = section[0] * cosine - section[1] * sine, z = section[0] * sine + section[1] * cosine;
    return {x, z, section[2], -x * force};
  };
  Eigen::Vector4d state(0, 0, 0, moment);
  constexpr int steps = 400;
  const double h = beam.length / steps;
  for (int i = 0; i < steps; ++i) {
    const Eigen::Vector4d k1 = rate(state), k2 = rate(state + h / 2 * k1), k3 = rate(state + h / 2 * k2),
                          k4 = rate(state + h * k3);
    state += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return state;
}

}  // namespace

Vector2 StvkBeam::tip_under_moment(double moment) const { return shoot(*this, moment, 0).head<2>(); }

Vector2 StvkBeam::tip_under_force(double force) const {
  double low = 0, high = force * length;  // of the moment at the clamp
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (shoot(*this, middle, force)[3] < 0 ? low : high) = middle;
  }
  return shoot(*this, high, force).head<2>();
}

}  // namespace taut
