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
  Matrix slopes = Matrix::Zero(width, gradient || hessian ? count : 0);  // of each node
  Matrix curvatures(width * width, hessian ? count : 0);                 // of those that are curved
  std::vector<char> curved(hessian ? nodes.size() : 0, 0);
  const auto curvature = [&](Index node) {
    return Eigen::Map<Matrix>(curvatures.data() + node * width * width, width, width);
  };
  const auto varies = [&](int node) { return node >= 0 && nodes[node].what != NlOperator::constant; };
  for (Index k = 0; k < count; ++k) {
    const Node& node = nodes[k];
    if (node.what == NlOperator::constant) {
      values[k] = node.value;
      continue;
    }
    if (node.what == NlOperator::variable) {
      values[k] = x[node.left];
      if (slopes.size() > 0) slopes(node.left, k) = 1;
      continue;
    }
    const bool a_varies = varies(node.left), b_varies = varies(node.right);
    Partials p = partials(node.what, values[node.left], node.right >= 0 ? values[node.right] : 0, b_varies);
    values[k] = p.value;
    if (slopes.size() == 0) continue;
    if (!a_varies) p.a = p.aa = p.ab = 0;
    if (!b_varies) p.b = p.bb = p.ab = 0;
    const auto a = slopes.col(node.left), b = slopes.col(b_varies ? node.right : node.left);
    slopes.col(k) = p.a * a + p.b * b;
    if (!hessian) continue;
    const bool a_curved = curved[node.left], b_curved = b_varies && curved[node.right];
    curved[k] = a_curved || b_curved || p.aa != 0 || p.ab != 0 || p.bb != 0;
    if (!curved[k]) continue;
    auto h = curvature(k);
    h.setZero();
    if (a_curved) h += p.a * curvature(node.left);
    if (b_curved) h += p.b * curvature(node.right);
    if (p.aa != 0) h += p.aa * a * a.transpose();
    if (p.bb != 0) h += p.bb * b * b.transpose();
    if (p.ab != 0) h += p.ab * (a * b.transpose() + b * a.transpose());
  }
  if (gradient) Eigen::Map<Vector>(gradient, width) = slopes.col(count - 1);
  if (hessian) {
    Eigen::Map<Matrix> whole(hessian, width, width);
    curved.back() ? whole = curvature(count - 1) : whole.setZero();
  }
  return values[count - 1];
}

}  // namespace taut
