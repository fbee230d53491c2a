#include "problems/nl_step.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "constraints/obstacle.h"
#include "constraints/strain_limit.h"
#include "energies/foundation.h"
#include "energies/hinge_bending.h"
#include "energies/inertia.h"
#include "energies/membrane.h"
#include "energies/stiffness_damping.h"
#include "problems/scene.h"
#include "solvers/nonlinear_program.h"

namespace taut {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A vector in space.
using NlPoint = std::array<NlExpression, 3>;

/// sum_k weights[k] x_{vertices[k]}, without the terms of weight zero.
template <class Vertices, class Weights>
NlPoint combination(const Vertices& vertices, const Weights& weights) {
  NlPoint point;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<NlExpression> terms;
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      const double weight = weights[static_cast<Index>(k)];
      if (weight != 0) terms.push_back(weight * NlExpression::variable(3 * vertices[k] + axis));
    }
    point[static_cast<std::size_t>(axis)] = sum(terms);
  }
  return point;
}

NlPoint difference(int to, int from) {
  NlPoint point;
  for (int axis = 0; axis < 3; ++axis)
    point[static_cast<std::size_t>(axis)] =
        NlExpression::variable(3 * to + axis) - NlExpression::variable(3 * from + axis);
  return point;
}

NlExpression dot(const NlPoint& a, const NlPoint& b) { return sum({a[0] * b[0], a[1] * b[1], a[2] * b[2]}); }
NlExpression norm_squared(const NlPoint& a) { return sum({square(a[0]), square(a[1]), square(a[2])}); }

/// C = F^T F.
struct NlStretch {
  NlExpression c11, c12, c22;

  explicit NlStretch(const RestTriangle& triangle) {
    const NlPoint f1 = combination(triangle.vertices, triangle.shape.col(0)),
                  f2 = combination(triangle.vertices, triangle.shape.col(1));
    c11 = norm_squared(f1);
    c12 = dot(f1, f2);
    c22 = norm_squared(f2);
  }
};

NlExpression stvk(const RestTriangle& triangle, Lame lame, double thickness) {
  const NlStretch c(triangle);
  const NlExpression e11 = 0.5 * (c.c11 - 1), e22 = 0.5 * (c.c22 - 1), e12 = 0.5 * c.c12;
  return triangle.area * thickness *
         (lame.mu * sum({square(e11), square(e22), 2.0 * square(e12)}) + 0.5 * lame.lambda * square(e11 + e22));
}

/// k/2 (theta - rest)^2 with theta = atan2(-|e| n1.b, n1.n2), n1 = e x a, n2 = b x e.
NlExpression hinge_energy(const Hinge& hinge) {
  const auto [x0, x1, x2, x3] = hinge.vertices;
  const NlPoint e = difference(x1, x0), a = difference(x2, x0), b = difference(x3, x0);
  const NlPoint n1{e[1] * a[2] - e[2] * a[1], e[2] * a[0] - e[0] * a[2], e[0] * a[1] - e[1] * a[0]};
  const NlExpression sine = -(sqrt(norm_squared(e)) * dot(n1, b)),
                     cosine = dot(e, b) * dot(a, e) - norm_squared(e) * dot(a, b);
  return 0.5 * hinge.stiffness * square(atan2(sine, cosine) - hinge.rest_angle);
}

/// Collects the rows and the objective of a step.
class StepWriter {
 public:
  StepWriter(const Problem& problem, const std::string& source) : problem_(problem), source_(source) {}

  void add(const Energy& energy);
  void add(const Constraint& constraint);
  void add(const LinearEqualities& equal);
  NlFile finish();

 private:
  void add_quadratic(const Energy& energy);
  void add_limit(const MatrixStrainLimit& limit);
  void add_obstacle(const Obstacle& obstacle);
  [[noreturn]] void refuse(const std::string& name, const std::string& why) const {
    throw InputError(source_ + ": found " + name + " in the step to export, allowed: " + why);
  }

  const Problem& problem_;
  const std::string& source_;
  NlFile file_;
  std::vector<NlExpression> terms_;
  double constant_ = 0;
};

void StepWriter::add(const Energy& energy) {
  if (!energy.has_curvature() || dynamic_cast<const Inertia*>(&energy) ||
      dynamic_cast<const WinklerFoundation*>(&energy) || dynamic_cast<const StiffnessDamping*>(&energy))
    return add_quadratic(energy);
  if (const auto* membrane = dynamic_cast<const Membrane*>(&energy); membrane && membrane->law() == MembraneLaw::stvk) {
    for (const RestTriangle& triangle : membrane->triangles())
      terms_.push_back(stvk(triangle, membrane->lame(), membrane->thickness()));
    return;
  }
  if (const auto* bending = dynamic_cast<const HingeBending*>(&energy)) {
    for (const Hinge& hinge : bending->hinges()) terms_.push_back(hinge_energy(hinge));
    return;
  }
  refuse(energy.name(), "inertia, constant loads, foundations, stiffness damping, stvk membranes, hinge bending");
}

/// Its Taylor series at the start, which ends after two terms.
void StepWriter::add_quadratic(const Energy& energy) {
  const Stencils& stencils = energy.stencils();
  const int width = stencils.width();
  Vector x(width), gradient(width);
  Matrix hessian = Matrix::Zero(width, width);
  for (Index element = 0; element < stencils.count(); ++element) {
    stencils.gather(element, problem_.initial_guess, x.data());
    constant_ += energy.evaluate(element, x.data(), gradient.data(), energy.has_curvature() ? hessian.data() : nullptr,
                                 Curvature::exact) -
                 gradient.dot(x);
    const auto moved = [&](int i) { return NlExpression::variable(stencils[element][i]) - x[i]; };
    for (int i = 0; i < width; ++i) {
      file_.objective.linear[stencils[element][i]] += gradient[i];
      if (hessian(i, i) != 0) terms_.push_back(0.5 * hessian(i, i) * square(moved(i)));
      for (int j = 0; j < i; ++j) {
        if (hessian(i, j) != 0) terms_.push_back(hessian(i, j) * (moved(i) * moved(j)));
      }
    }
  }
}

void StepWriter::add(const Constraint& constraint) {
  if (const auto* limit = dynamic_cast<const MatrixStrainLimit*>(&constraint)) return add_limit(*limit);
  if (const auto* obstacle = dynamic_cast<const Obstacle*>(&constraint)) return add_obstacle(*obstacle);
  refuse(constraint.name() + " (" + std::to_string(constraint.rows()) + " rows an element)",
         "strain limits of the form \"matrix\", obstacles, pins, couplings");
}

/// The rows of SpectralBox::smooth_values.
void StepWriter::add_limit(const MatrixStrainLimit& constraint) {
  const StrainLimitTriangles& limit = constraint.limit();
  const double upper = limit.max * limit.max, lower = limit.min * limit.min;
  const double scale = std::isfinite(upper) ? upper : lower;
  for (std::size_t element = 0; element < limit.triangles.size(); ++element) {
    const NlStretch c(limit.triangles[element]);
    const std::string name = limit.constraint + ": " + limit.element_name(static_cast<Index>(element)) + ", ";
    const auto add_row = [&](const std::string& what, const NlExpression& row, double low, double high) {
      file_.rows.push_back({name + what, {row, {}}, low, high});
    };
    if (upper == lower) {
      add_row("C11", (1 / scale) * c.c11, 1, 1);
      add_row("C12", (std::numbers::sqrt2 / scale) * c.c12, 0, 0);
      add_row("C22", (1 / scale) * c.c22, 1, 1);
      continue;
    }
    const auto add_side = [&](const std::string& side, double value, double sign) {
      const NlExpression a11 = (sign / scale) * (c.c11 - value), a22 = (sign / scale) * (c.c22 - value);
      add_row(side + " trace", a11 + a22, 0, infinity);
      add_row(side + " determinant", a11 * a22 - square((1 / scale) * c.c12), 0, infinity);
    };
    if (std::isfinite(upper)) add_side("upper", upper, -1);
    if (lower > 0) add_side("lower", lower, 1);
  }
}

void StepWriter::add_obstacle(const Obstacle& obstacle) {
  const auto* sphere = dynamic_cast<const SphereObstacle*>(&obstacle);
  const Stencils& stencils = obstacle.stencils();
  for (Index element = 0; element < stencils.count(); ++element) {
    NlFile::Row row{obstacle.name() + ": " + obstacle.element_name(element), {}, 0, infinity};
    const int* variables = stencils[element];
    if (sphere) {
      NlPoint offset;
      for (int axis = 0; axis < 3; ++axis)
        offset[static_cast<std::size_t>(axis)] = NlExpression::variable(variables[axis]) - sphere->center()[axis];
      row.function.nonlinear = sqrt(norm_squared(offset)) - sphere->radius();
    } else {
      // n . x - n . p: linear, so that the origin tells the constant.
      Vector3 normal;
      double at_origin;
      obstacle.evaluate(element, Vector3(Vector3::Zero()).data(), &at_origin, normal.data());
      for (int axis = 0; axis < 3; ++axis) row.function.linear[variables[axis]] = normal[axis];
      row.lower = -at_origin;
    }
    file_.rows.push_back(std::move(row));
  }
}

void StepWriter::add(const LinearEqualities& equal) {
  const auto first = file_.rows.size();
  for (Index row = 0; row < equal.rows.rows(); ++row)
    file_.rows.push_back({equal.name + ": " + equal.row_name(row), {}, equal.values[row], equal.values[row]});
  for (Index column = 0; column < equal.rows.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(equal.rows, column); entry; ++entry)
      file_.rows[first + static_cast<std::size_t>(entry.row())].function.linear[static_cast<int>(column)] =
          entry.value();
  }
}

NlFile StepWriter::finish() {
  terms_.emplace_back(constant_);
  file_.objective.nonlinear = sum(terms_);
  file_.start = problem_.initial_guess;
  file_.lower = Vector::Constant(problem_.size(), -infinity);
  file_.upper = Vector::Constant(problem_.size(), infinity);
  for (std::size_t i = 0; i < problem_.fixed_variables.size(); ++i)
    file_.lower[problem_.fixed_variables[i]] = file_.upper[problem_.fixed_variables[i]] =
        problem_.fixed_values[static_cast<Index>(i)];
  return std::move(file_);
}

}  // namespace

NlFile step_as_nl(const Problem& problem, const WarmStart& warm, std::vector<std::string> variable_names,
                  const std::string& source) {
  StepWriter writer(problem, source);
  for (const Energy* energy : problem.energies) writer.add(*energy);
  for (const Constraint* constraint : problem.constraints) writer.add(*constraint);
  for (const LinearEqualities* equal : problem.equalities) writer.add(*equal);
  NlFile file = writer.finish();
  file.variable_names = std::move(variable_names);
  const NonlinearProgram program(problem);  // its rows are those above, in the same order
  const Vector multipliers = program.row_multipliers(program.start(), warm.multipliers);
  for (std::size_t i = 0; i < file.rows.size(); ++i) file.rows[i].dual = -multipliers[static_cast<Index>(i)];
  return file;
}

}  // namespace taut
