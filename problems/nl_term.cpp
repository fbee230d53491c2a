#include "problems/nl_term.h"

#include <cmath>
#include <numbers>

#include "core/types.h"

namespace taut {
namespace {

/// A function of two numbers and its partial derivatives; those in b stay zero where there is only one.
struct Partials {
  double value, a = 0, b = 0, aa = 0, ab = 0, bb = 0;
};

/// a^b, whose derivatives in b are for exponents that vary.
Partials power(double a, double b, bool exponent_varies) {
  const auto times_power = [&](double factor, double exponent) {
    return factor == 0 ? 0.0 : factor * std::pow(a, exponent);
  };
  Partials p{std::pow(a, b), times_power(b, b - 1), 0, times_power(b * (b - 1), b - 2)};
  if (!exponent_varies) return p;
  const double log = std::log(a);
  p.b = p.value * log;
  p.ab = std::pow(a, b - 1) * (1 + b * log);
  p.bb = p.b * log;
  return p;
}

Partials partials(NlOperator what, double a, double b, bool b_varies) {
  switch (what) {
    case NlOperator::plus:
      return {a + b, 1, 1};
    case NlOperator::minus:
      return {a - b, 1, -1};
    case NlOperator::times:
      return {a * b, b, a, 0, 1, 0};
    case NlOperator::divide:
      return {a / b, 1 / b, -a / (b * b), 0, -1 / (b * b), 2 * a / (b * b * b)};
    case NlOperator::power:
      return power(a, b, b_varies);
    case NlOperator::atan2: {
      const double s = a * a + b * b;
      return {std::atan2(a, b), b / s, -a / s, -2 * a * b / (s * s), (a * a - b * b) / (s * s), 2 * a * b / (s * s)};
    }
    case NlOperator::negate:
      return {-a, -1};
    case NlOperator::sqrt: {
      const double root = std::sqrt(a);
      return {root, 0.5 / root, 0, -0.25 / (a * root)};
    }
    case NlOperator::exp:
      return {std::exp(a), std::exp(a), 0, std::exp(a)};
    case NlOperator::log:
      return {std::log(a), 1 / a, 0, -1 / (a * a)};
    case NlOperator::log10:
      return {std::log10(a), std::numbers::log10e / a, 0, -std::numbers::log10e / (a * a)};
    case NlOperator::sin:
      return {std::sin(a), std::cos(a), 0, -std::sin(a)};
    case NlOperator::cos:
      return {std::cos(a), -std::sin(a), 0, -std::cos(a)};
    case NlOperator::tan: {
      const double t = std::tan(a), slope = 1 + t * t;
      return {t, slope, 0, 2 * t * slope};
    }
    case NlOperator::sinh:
      return {std::sinh(a), std::cosh(a), 0, std::sinh(a)};
    case NlOperator::cosh:
      return {std::cosh(a), std::sinh(a), 0, std::cosh(a)};
    case NlOperator::tanh: {
      const double t = std::tanh(a), slope = 1 - t * t;
      return {t, slope, 0, -2 * t * slope};
    }
    case NlOperator::asin: {
      const double s = 1 - a * a, root = std::sqrt(s);
      return {std::asin(a), 1 / root, 0, a / (s * root)};
    }
    case NlOperator::acos: {
      const double s = 1 - a * a, root = std::sqrt(s);
      return {std::acos(a), -1 / root, 0, -a / (s * root)};
    }
    case NlOperator::atan: {
      const double s = 1 + a * a;
      return {std::atan(a), 1 / s, 0, -2 * a / (s * s)};
    }
    case NlOperator::asinh: {
      const double s = 1 + a * a, root = std::sqrt(s);
      return {std::asinh(a), 1 / root, 0, -a / (s * root)};
    }
    case NlOperator::acosh: {
      const double s = a * a - 1, root = std::sqrt(s);
      return {std::acosh(a), 1 / root, 0, -a / (s * root)};
    }
    case NlOperator::atanh: {
      const double s = 1 - a * a;
      return {std::atanh(a), 1 / s, 0, 2 * a / (s * s)};
    }
    case NlOperator::constant:
    case NlOperator::variable:
      break;
  }
  return {0};
}

}  // namespace

double NlTerm::evaluate(const double* x, double* gradient, double* hessian) const {
  const auto width = static_cast<Index>(variables.size()), count = static_cast<Index>(nodes.size());
  Vector values(count);
  // Of each node; nodes without variables have zeros.
  Matrix slopes = Matrix::Zero(width, gradient || hessian ? count : 0);
  Matrix curvatures = Matrix::Zero(width * width, hessian ? count : 0);
  const auto curvature = [&](Index node) {
    return Eigen::Map<Matrix>(curvatures.data() + node * width * width, width, width);
  };
  for (Index k = 0; k < count; ++k) {
    const Node& node = nodes[static_cast<std::size_t>(k)];
    if (node.what == NlOperator::constant) {
      values[k] = node.value;
      continue;
    }
    if (node.what == NlOperator::variable) {
      values[k] = x[node.left];
      if (slopes.size() > 0) slopes(node.left, k) = 1;
      continue;
    }
    const bool binary = node.right >= 0;
    const bool b_varies = binary && nodes[static_cast<std::size_t>(node.right)].what != NlOperator::constant;
    const Partials p = partials(node.what, values[node.left], binary ? values[node.right] : 0, b_varies);
    values[k] = p.value;
    if (slopes.size() == 0) continue;
    const auto a = slopes.col(node.left);
    slopes.col(k) = p.a * a;
    if (b_varies) slopes.col(k) += p.b * slopes.col(node.right);
    if (!hessian) continue;
    curvature(k) = p.a * curvature(node.left) + p.aa * a * a.transpose();
    if (!b_varies) continue;
    const auto b = slopes.col(node.right);
    curvature(k) +=
        p.b * curvature(node.right) + p.bb * b * b.transpose() + p.ab * (a * b.transpose() + b * a.transpose());
  }
  if (gradient) Eigen::Map<Vector>(gradient, width) = slopes.col(count - 1);
  if (hessian) Eigen::Map<Matrix>(hessian, width, width) = curvature(count - 1);
  return values[count - 1];
}

}  // namespace taut
