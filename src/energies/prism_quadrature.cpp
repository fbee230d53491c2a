#include "energies/prism_quadrature.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace taut {
namespace {

/// The three points with two coordinates (1 - a)/2 and one a.
void add_orbit(std::vector<TrianglePoint>& rule, double a, double weight) {
  for (int j = 0; j < 3; ++j) {
    TrianglePoint point{Vector3::Constant(0.5 * (1 - a)), weight};
    point.l[j] = a;
    rule.push_back(point);
  }
}

std::vector<TrianglePoint> six_points() {
  std::vector<TrianglePoint> rule;
  add_orbit(rule, 0.108103018168070, 0.5 * 0.223381589678011);
  add_orbit(rule, 0.816847572980459, 0.5 * 0.109951743655322);
  return rule;
}

std::vector<TrianglePoint> three_points() {
  std::vector<TrianglePoint> rule;
  add_orbit(rule, 2.0 / 3, 1.0 / 6);
  return rule;
}

std::vector<LinePoint> four_gauss_points() {
  const double root = std::sqrt(6.0 / 5), near = std::sqrt((3 - 2 * root) / 7), far = std::sqrt((3 + 2 * root) / 7);
  const double heavy = (18 + std::sqrt(30.0)) / 36, light = (18 - std::sqrt(30.0)) / 36;
  return {{-far, light}, {-near, heavy}, {near, heavy}, {far, light}};
}

}  // namespace

const std::vector<TrianglePoint>& triangle_rule(int points) {
  static const std::vector<TrianglePoint> one{{Vector3::Constant(1.0 / 3), 0.5}}, three = three_points(),
                                                                                  six = six_points();
  switch (points) {
    case 1:
      return one;
    case 3:
      return three;
    case 6:
      return six;
    default:
      throw std::invalid_argument("triangle_rule: expected 1, 3 or 6 points, got " + std::to_string(points));
  }
}

const std::vector<LinePoint>& gauss_rule(int points) {
  static const std::vector<LinePoint> rules[] = {{{0, 2}},
                                                 {{-std::sqrt(1.0 / 3), 1}, {std::sqrt(1.0 / 3), 1}},
                                                 {{-std::sqrt(0.6), 5.0 / 9}, {0, 8.0 / 9}, {std::sqrt(0.6), 5.0 / 9}},
                                                 four_gauss_points()};
  if (points < 1 || points > 4) {
    throw std::invalid_argument("gauss_rule: expected 1 to 4 points, got " + std::to_string(points));
  }
  return rules[points - 1];
}

}  // namespace taut
