#include "solvers/nonlinear_program.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "core/assembly.h"
#include "core/scratch.h"
#include "solvers/equality_rows.h"

namespace taut {
namespace {

/// sigma times an energy.
class Scaled final : public Energy {
 public:
  Scaled(const Energy& energy, const double& sigma) : energy_(energy), sigma_(sigma) {}
  std::string name() const override { return energy_.name(); }
  const Stencils& stencils() const override { return energy_.stencils(); }
  bool has_curvature() const override { return energy_.has_curvature(); }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override {
    const double value = energy_.evaluate(element, x, gradient, hessian, curvature);
    const int width = stencils().width();
    if (gradient) Eigen::Map<Vector>(gradient, width) *= sigma_;
    if (hessian) Eigen::Map<Vector>(hessian, width * width) *= sigma_;
    return sigma_ * value;
  }

 private:
  const Energy& energy_;
  const double& sigma_;
};

/// One element's c and g with their first derivatives.
struct Rows {
  explicit Rows(const Constraint& constraint)
      : x(constraint.stencils().width()), c_jacobian(constraint.rows() * constraint.stencils().width()) {}
  Scratch<max_stencil_width> x;
  std::array<double, max_rows> c;
  std::array<double, max_smooth_rows> g;
  Scratch<max_rows * max_stencil_width> c_jacobian;
  std::array<double, max_smooth_rows * max_rows> g_jacobian;
};

void evaluate_rows(const Constraint& constraint, Index element, const double* x, bool derivatives, Rows& rows) {
  constraint.evaluate(element, x, rows.c.data(), derivatives ? rows.c_jacobian.data() : nullptr);
  constraint.set().smooth_values(element, rows.c.data(), rows.g.data(), derivatives ? rows.g_jacobian.data() : nullptr);
}

/// sum_i nu_i g_i(c(x)) of a constraint, as an energy, so that Assembly sums its Hessian.
class WeightedRows final : public Energy {
 public:
  WeightedRows(const Constraint& constraint, Index first_row, const Vector& nu)
      : constraint_(constraint), first_row_(first_row), nu_(nu) {}
  std::string name() const override { return constraint_.name(); }
  const Stencils& stencils() const override { return constraint_.stencils(); }
  /// Always exact: a Lagrangian's Hessian has no use for a semidefinite part.
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature /*curvature*/) const override {
    const int rows = constraint_.set().smooth_rows(), dimension = constraint_.rows(), width = stencils().width();
    Rows local(constraint_);
    evaluate_rows(constraint_, element, x, gradient != nullptr, local);
    const auto nu = nu_.segment(first_row_ + element * rows, rows);
    const double value = nu.dot(Eigen::Map<const Vector>(local.g.data(), rows));
    if (!gradient) return value;
    const Eigen::Map<const Matrix> c_jacobian(local.c_jacobian.data(), dimension, width);
    const Vector lambda = Eigen::Map<const Matrix>(local.g_jacobian.data(), rows, dimension).transpose() * nu;
    Eigen::Map<Vector>(gradient, width) = c_jacobian.transpose() * lambda;
    if (!hessian) return value;
    Matrix curvature(dimension, dimension);
    constraint_.set().smooth_hessian(element, local.c.data(), nu.data(), curvature.data());
    constraint_.hessian(element, x, lambda.data(), Curvature::exact, hessian);
    Eigen::Map<Matrix>(hessian, width, width) += c_jacobian.transpose() * curvature * c_jacobian;
    return value;
  }

 private:
  const Constraint& constraint_;
  Index first_row_;
  const Vector& nu_;
};

}  // namespace

struct NonlinearProgram::Data {
  std::uint64_t topology;
  std::vector<const Constraint*> constraints;
  EqualityRows equalities;
  std::vector<Index> first_row;  // of each constraint, and of the equalities behind them
  std::vector<int> free;         // variable of the problem for each of y
  std::vector<int> place;        // the inverse; -1 where fixed
  Vector full;                   // the problem's variables, scratch but for the fixed ones
  Vector lower, upper, start;
  TripletPattern jacobian, hessian;
  std::vector<Index> hessian_slot;  // where in lagrangian.matrix() each entry is
  double sigma = 1;
  Vector nu;
  std::deque<Scaled> scaled;
  std::deque<WeightedRows> weighted;
  std::unique_ptr<Assembly> objective, lagrangian;

  explicit Data(const Problem& problem);
  void find_free(const Problem& problem);
  void build_rows();
  void build_hessian(const Problem& problem);
  const Vector& expand(const Vector& y) {
    for (std::size_t i = 0; i < free.size(); ++i) full[free[i]] = y[static_cast<Index>(i)];
    return full;
  }
  /// Calls visit(constraint index, element, first row, rows) for every element at y.
  template <class Visit>
  void for_elements(const Vector& y, bool derivatives, const Visit& visit);
  template <class Visit>
  void for_equalities(const Visit& visit) const;
};

NonlinearProgram::Data::Data(const Problem& problem)
    : topology(problem.topology), constraints(problem.constraints), equalities(problem) {
  problem.validate();
  find_free(problem);
  build_rows();
  objective = std::make_unique<Assembly>(problem.size(), problem.energies, problem.fixed_variables, 1);
  build_hessian(problem);
}

void NonlinearProgram::Data::find_free(const Problem& problem) {
  place.assign(static_cast<std::size_t>(problem.size()), 0);
  for (int variable : problem.fixed_variables) place[variable] = -1;
  for (int variable = 0; variable < static_cast<int>(problem.size()); ++variable) {
    if (place[variable] < 0) continue;
    place[variable] = static_cast<int>(free.size());
    free.push_back(variable);
  }
}

/// The equalities' part of the Jacobian, which is constant: calls visit(row, variable of y, value).
template <class Visit>
void NonlinearProgram::Data::for_equalities(const Visit& visit) const {
  for (Index column = 0; column < equalities.rows().outerSize(); ++column) {
    if (place[static_cast<std::size_t>(column)] < 0) continue;
    for (SparseMatrix::InnerIterator entry(equalities.rows(), column); entry; ++entry)
      visit(first_row.back() + entry.row(), place[static_cast<std::size_t>(column)], entry.value());
  }
}

void NonlinearProgram::Data::build_rows() {
  Index count = 0;
  for (const Constraint* constraint : constraints) {
    first_row.push_back(count);
    count += constraint->stencils().count() * constraint->set().smooth_rows();
  }
  first_row.push_back(count);
  lower.setZero(count + equalities.count());
  upper = nu = lower;
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    const Stencils& stencils = constraints[k]->stencils();
    const int rows = constraints[k]->set().smooth_rows();
    for (Index element = 0; element < stencils.count(); ++element) {
      const Index first = first_row[k] + element * rows;
      constraints[k]->set().smooth_bounds(lower.data() + first, upper.data() + first);
      for (int i = 0; i < stencils.width(); ++i) {
        if (place[stencils[element][i]] < 0) continue;
        for (int row = 0; row < rows; ++row) {
          jacobian.rows.push_back(static_cast<int>(first) + row);
          jacobian.columns.push_back(place[stencils[element][i]]);
        }
      }
    }
  }
  for_equalities([&](Index row, int column, double) {
    jacobian.rows.push_back(static_cast<int>(row));
    jacobian.columns.push_back(column);
  });
}

void NonlinearProgram::Data::build_hessian(const Problem& problem) {
  std::vector<const Energy*> terms;
  for (const Energy* energy : problem.energies) terms.push_back(&scaled.emplace_back(*energy, sigma));
  for (std::size_t k = 0; k < constraints.size(); ++k)
    terms.push_back(&weighted.emplace_back(*constraints[k], first_row[k], nu));
  lagrangian = std::make_unique<Assembly>(problem.size(), terms, problem.fixed_variables, 1);

  Vector variable;  // which of the problem each row of the assembled matrix is
  lagrangian->to_ordered(Vector::LinSpaced(problem.size(), 0, static_cast<double>(problem.size() - 1)), variable);
  const SparseMatrix& matrix = lagrangian->matrix();
  for (Index column = 0; column < matrix.outerSize(); ++column) {
    for (Index slot = matrix.outerIndexPtr()[column]; slot < matrix.outerIndexPtr()[column + 1]; ++slot) {
      const Index row = matrix.innerIndexPtr()[slot];
      const int i = place[static_cast<std::size_t>(std::lround(variable[row]))];
      const int j = place[static_cast<std::size_t>(std::lround(variable[column]))];
      if (row < column || i < 0 || j < 0) continue;
      hessian.rows.push_back(std::max(i, j));
      hessian.columns.push_back(std::min(i, j));
      hessian_slot.push_back(slot);
    }
  }
}

template <class Visit>
void NonlinearProgram::Data::for_elements(const Vector& y, bool derivatives, const Visit& visit) {
  const Vector& x = expand(y);
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    const Constraint& constraint = *constraints[k];
    Rows local(constraint);
    for (Index element = 0; element < constraint.stencils().count(); ++element) {
      constraint.stencils().gather(element, x, local.x.data());
      evaluate_rows(constraint, element, local.x.data(), derivatives, local);
      visit(k, element, first_row[k] + element * constraint.set().smooth_rows(), local);
    }
  }
}

NonlinearProgram::NonlinearProgram(const Problem& problem) : data_(std::make_unique<Data>(problem)) { update(problem); }
NonlinearProgram::~NonlinearProgram() = default;

bool NonlinearProgram::fits(const Problem& problem) const {
  return problem.topology != 0 && problem.topology == data_->topology;
}

void NonlinearProgram::update(const Problem& problem) {
  Data& d = *data_;
  d.full = problem.initial_guess;
  d.equalities.update(problem);
  d.lower.tail(d.equalities.count()) = d.upper.tail(d.equalities.count()) = d.equalities.values();
  for (std::size_t i = 0; i < problem.fixed_variables.size(); ++i)
    d.full[problem.fixed_variables[i]] = problem.fixed_values[static_cast<Index>(i)];
  d.start = d.full(d.free);
}

Index NonlinearProgram::variables() const { return static_cast<Index>(data_->free.size()); }
Index NonlinearProgram::rows() const { return data_->lower.size(); }
const Vector& NonlinearProgram::lower() const { return data_->lower; }
const Vector& NonlinearProgram::upper() const { return data_->upper; }
const TripletPattern& NonlinearProgram::jacobian_pattern() const { return data_->jacobian; }
const TripletPattern& NonlinearProgram::hessian_pattern() const { return data_->hessian; }
Vector NonlinearProgram::start() const { return data_->start; }
Vector NonlinearProgram::expand(const Vector& y) const { return data_->expand(y); }

double NonlinearProgram::objective(const Vector& y) { return data_->objective->value(data_->expand(y)); }

double NonlinearProgram::gradient(const Vector& y, Vector& gradient) {
  Vector full;
  const double value = data_->objective->gradient(data_->expand(y), full);
  gradient = full(data_->free);
  return value;
}

void NonlinearProgram::constraints(const Vector& y, Vector& g) const {
  g.resize(rows());
  data_->for_elements(y, false, [&](std::size_t k, Index, Index first, Rows& local) {
    std::copy_n(local.g.data(), data_->constraints[k]->set().smooth_rows(), g.data() + first);
  });
  if (data_->equalities.count() == 0) return;
  g.tail(data_->equalities.count()) = data_->equalities.rows() * data_->expand(y);
}

void NonlinearProgram::jacobian(const Vector& y, Vector& values) const {
  values.resize(static_cast<Index>(data_->jacobian.rows.size()));
  Index next = 0;
  data_->for_elements(y, true, [&](std::size_t k, Index element, Index, Rows& local) {
    const Constraint& constraint = *data_->constraints[k];
    const int rows = constraint.set().smooth_rows(), dimension = constraint.rows();
    const Eigen::Map<const Matrix> g_jacobian(local.g_jacobian.data(), rows, dimension);
    for (int i = 0; i < constraint.stencils().width(); ++i) {
      if (data_->place[constraint.stencils()[element][i]] < 0) continue;
      values.segment(next, rows) =
          g_jacobian * Eigen::Map<const Vector>(local.c_jacobian.data() + i * dimension, dimension);
      next += rows;
    }
  });
  data_->for_equalities([&](Index, int, double value) { values[next++] = value; });
}

void NonlinearProgram::hessian(const Vector& y, double sigma, const Vector& nu, Vector& values) {
  Data& d = *data_;
  d.sigma = sigma;
  d.nu = nu;
  d.lagrangian->hessian(d.expand(y), Curvature::exact);
  values.resize(static_cast<Index>(d.hessian_slot.size()));
  for (std::size_t i = 0; i < d.hessian_slot.size(); ++i)
    values[static_cast<Index>(i)] = d.lagrangian->matrix().valuePtr()[d.hessian_slot[i]];
}

std::vector<Vector> NonlinearProgram::multipliers(const Vector& y, const Vector& nu) const {
  std::vector<Vector> result;
  for (const Constraint* constraint : data_->constraints)
    result.emplace_back(Vector::Zero(constraint->stencils().count() * constraint->rows()));
  data_->for_elements(y, true, [&](std::size_t k, Index element, Index first, Rows& local) {
    const Constraint& constraint = *data_->constraints[k];
    const int rows = constraint.set().smooth_rows(), dimension = constraint.rows();
    const Eigen::Map<const Matrix> g_jacobian(local.g_jacobian.data(), rows, dimension);
    result[k].segment(element * dimension, dimension) =
        g_jacobian.transpose() * nu.segment(first, rows) / constraint.weight(element);
  });
  data_->equalities.put(nu.tail(data_->equalities.count()), data_->constraints.size(), result);
  return result;
}

Vector NonlinearProgram::row_multipliers(const Vector& y, const std::vector<Vector>& multipliers) const {
  Vector nu = Vector::Zero(rows());
  if (multipliers.empty()) return nu;
  data_->for_elements(y, true, [&](std::size_t k, Index element, Index first, Rows& local) {
    const Constraint& constraint = *data_->constraints[k];
    const int rows = constraint.set().smooth_rows(), dimension = constraint.rows();
    const Vector lambda = constraint.weight(element) * multipliers[k].segment(element * dimension, dimension);
    if (lambda.isZero(0)) return;
    const Matrix transposed = Eigen::Map<const Matrix>(local.g_jacobian.data(), rows, dimension).transpose();
    nu.segment(first, rows) = transposed.completeOrthogonalDecomposition().solve(lambda);
  });
  nu.tail(data_->equalities.count()) = data_->equalities.stacked(multipliers, data_->constraints.size());
  return nu;
}

}  // namespace taut
