#include "problems/nl_problem.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "constraints/convex_sets.h"
#include "problems/nl_term.h"
#include "problems/scene.h"

namespace taut {
namespace {

constexpr double largest_derivative = 100;  // of a row at the start [Waechter and Biegler 2006, 3.8]

/// Eigenvalues replaced by their absolute values: a step is long where the curvature is small, whatever its sign.
void make_positive_semidefinite(double* entries, Index width) {
  Eigen::Map<Matrix> hessian(entries, width, width);
  if (!hessian.allFinite()) return;
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(hessian);
  if (solver.eigenvalues().minCoeff() >= 0) return;
  hessian = solver.eigenvectors() * solver.eigenvalues().cwiseAbs().asDiagonal() * solver.eigenvectors().transpose();
}

/// A function's value and derivatives as those of an energy: negated where it is maximised.
double as_energy(double value, double sign, Index width, double* gradient, double* hessian, Curvature curvature) {
  if (sign < 0 && gradient) Eigen::Map<Vector>(gradient, width) *= -1;
  if (sign < 0 && hessian) Eigen::Map<Vector>(hessian, width * width) *= -1;
  if (hessian && curvature == Curvature::positive_semidefinite) make_positive_semidefinite(hessian, width);
  return sign * value;
}

class NlObjective final : public Energy {
 public:
  explicit NlObjective(const NlModel& model)
      : model_(model),
        sign_(model.maximise() ? -1 : 1),
        stencils_(static_cast<int>(model.variables_of(NlModel::objective).size())) {
    stencils_.add(model.variables_of(NlModel::objective));
  }
  std::string name() const override { return "objective"; }
  const Stencils& stencils() const override { return stencils_; }
  bool has_curvature() const override { return !model_.linear(NlModel::objective); }
  double evaluate(Index, const double* x, double* gradient, double* hessian, Curvature curvature) const override {
    const double value = model_.evaluate(NlModel::objective, x, gradient, hessian);
    return as_energy(value, sign_, stencils_.width(), gradient, hessian, curvature);
  }

 private:
  const NlModel& model_;
  double sign_;
  Stencils stencils_;
};

/// Terms of the objective with the same number of variables, an element each.
class NlTerms final : public Energy {
 public:
  NlTerms(int width, double sign) : sign_(sign), stencils_(width) {}
  void add(NlTerm term) {
    stencils_.add(term.variables);
    terms_.push_back(std::move(term));
  }
  std::string name() const override { return "objective"; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override {
    const double value = terms_[static_cast<std::size_t>(element)].evaluate(x, gradient, hessian);
    return as_energy(value, sign_, stencils_.width(), gradient, hessian, curvature);
  }

 private:
  double sign_;
  Stencils stencils_;
  std::vector<NlTerm> terms_;
};

/// lower <= scale g(x) <= upper for one row.
class NlRow final : public Constraint {
 public:
  NlRow(const NlModel& model, int row, double scale)
      : model_(model),
        row_(row),
        scale_(scale),
        set_(1, scale * model.row_lower()[row], scale * model.row_upper()[row]),
        stencils_(static_cast<int>(model.variables_of(row).size())) {
    stencils_.add(model.variables_of(row));
  }
  std::string name() const override { return model_.row_name(row_); }
  const Stencils& stencils() const override { return stencils_; }
  int rows() const override { return 1; }
  const ConvexSet& set() const override { return set_; }
  void evaluate(Index, const double* x, double* c, double* jacobian) const override {
    *c = scale_ * model_.evaluate(row_, x, jacobian, nullptr);
    if (jacobian) Eigen::Map<Vector>(jacobian, stencils_.width()) *= scale_;
  }
  void hessian(Index, const double* x, const double* multipliers, Curvature curvature, double* hessian) const override {
    const Index width = stencils_.width();
    model_.evaluate(row_, x, nullptr, hessian);
    Eigen::Map<Vector>(hessian, width * width) *= scale_ * *multipliers;
    if (curvature == Curvature::positive_semidefinite) make_positive_semidefinite(hessian, width);
  }
  double violation(Index, const double* x) const override {
    const double value = model_.evaluate(row_, x, nullptr, nullptr);
    if (std::isnan(value)) return value;  // a comparison with it would say that nothing is violated
    return std::max({0.0, model_.row_lower()[row_] - value, value - model_.row_upper()[row_]});
  }
  std::string element_name(Index) const override { return "row " + name(); }

 private:
  const NlModel& model_;
  int row_;
  double scale_;
  Box set_;
  Stencils stencils_;
};

/// Bounds of variables as one constraint, c = x_i - its bound, the lower one where it has both.
class NlBounds final : public Constraint {
 public:
  /// All of them have the same distance between their bounds, or only lower or only upper ones.
  NlBounds(const NlModel& model, std::vector<int> variables)
      : model_(model), variables_(std::move(variables)), set_(set_of(model, variables_.front())) {
    for (const int variable : variables_) stencils_.add(std::array{variable});
  }
  std::string name() const override {
    return variables_.size() == 1 ? "bounds of " + model_.variable_name(variables_.front()) : "bounds";
  }
  const Stencils& stencils() const override { return stencils_; }
  int rows() const override { return 1; }
  const ConvexSet& set() const override { return set_; }
  void evaluate(Index element, const double* x, double* c, double* jacobian) const override {
    const int variable = variables_[static_cast<std::size_t>(element)];
    const double lower = model_.lower()[variable];
    *c = *x - (std::isfinite(lower) ? lower : model_.upper()[variable]);
    if (jacobian) *jacobian = 1;
  }
  void hessian(Index, const double*, const double*, Curvature, double* hessian) const override { *hessian = 0; }
  double violation(Index element, const double* x) const override {
    const int variable = variables_[static_cast<std::size_t>(element)];
    return std::max({0.0, model_.lower()[variable] - *x, *x - model_.upper()[variable]});
  }
  std::string element_name(Index element) const override {
    return "variable " + model_.variable_name(variables_[static_cast<std::size_t>(element)]);
  }

  /// What may be one constraint: the distance between the bounds; infinite with a sign where there is only the lower
  /// one, or only the upper.
  static double family(const NlModel& model, int variable) {
    return std::isfinite(model.lower()[variable]) ? model.upper()[variable] - model.lower()[variable]
                                                  : -std::numeric_limits<double>::infinity();
  }

 private:
  static Box set_of(const NlModel& model, int variable) {
    const double width = family(model, variable);
    return width > 0 ? Box(1, 0, width) : Box(1, width, 0);
  }

  const NlModel& model_;
  std::vector<int> variables_;
  Box set_;
  Stencils stencils_{1};
};

/// Beyond this a dense matrix of second derivatives takes more memory and time than anyone has.
constexpr std::size_t largest_width = 4000;
/// A wider nonlinear objective is taken apart into terms, and bounds are families with one penalty, where that can be
/// done.
constexpr int largest_small_width = max_stencil_width;

void check_width(const NlModel& model, int function, const std::string& what) {
  const std::size_t width = model.variables_of(function).size();
  if (width > largest_width && (function != NlModel::objective || !model.linear(function)))
    throw InputError(model.name() + ".nl: found " + std::to_string(width) + " variables in " + what +
                     ", allowed: " + std::to_string(largest_width) + ", as second derivatives are dense");
}

/// Bounds that cross, and rows without variables that do not hold, are no problem that a solver could be given.
void check_bounds(const NlModel& model) {
  const auto check = [&](const std::string& what, double lower, double upper) {
    if (lower > upper)
      throw InputError(model.name() + ".nl: found a lower bound above the upper one in " + what +
                       ", which no point satisfies");
  };
  for (int i = 0; i < model.variables(); ++i)
    check("variable " + model.variable_name(i), model.lower()[i], model.upper()[i]);
  for (int row = 0; row < model.rows(); ++row) {
    check("row " + model.row_name(row), model.row_lower()[row], model.row_upper()[row]);
    if (!model.variables_of(row).empty()) continue;
    const double value = model.evaluate(row, nullptr, nullptr, nullptr);
    if (value < model.row_lower()[row] || value > model.row_upper()[row])
      throw InputError(model.name() + ".nl: found row " + model.row_name(row) +
                       " without variables and outside its bounds, which no point changes");
  }
}

}  // namespace

NlProblem::NlProblem(const NlModel& model) : model_(model) {
  problem_.name = model.name();
  problem_.node_size = 1;
  problem_.topology = new_topology();
  problem_.initial_guess = model.start();
  check_bounds(model);
  const double sign = model.maximise() ? -1 : 1;
  std::vector<NlTerm> terms;
  if (model.has_objective() && !model.linear(NlModel::objective) &&
      model.variables_of(NlModel::objective).size() > largest_small_width)
    terms = objective_terms(model.file(), largest_small_width);
  std::vector<double> fixed;
  std::map<double, std::vector<int>> families;
  for (int i = 0; i < model.variables(); ++i) {
    const double lower = model.lower()[i], upper = model.upper()[i];
    if (lower == upper) {
      problem_.fixed_variables.push_back(i);
      fixed.push_back(lower);
    } else if (std::isfinite(lower) || std::isfinite(upper)) {
      if (terms.empty()) {
        constraints_.push_back(std::make_unique<NlBounds>(model, std::vector{i}));
      } else {
        families[NlBounds::family(model, i)].push_back(i);
      }
    }
    problem_.initial_guess[i] = std::clamp(problem_.initial_guess[i], lower, upper);
  }
  for (auto& [distance, variables] : families)
    constraints_.push_back(std::make_unique<NlBounds>(model, std::move(variables)));
  problem_.fixed_values = Eigen::Map<const Vector>(fixed.data(), static_cast<Index>(fixed.size()));
  for (int row = 0; row < model.rows(); ++row) {
    check_width(model, row, "row " + model.row_name(row));
    const bool bounded = std::isfinite(model.row_lower()[row]) || std::isfinite(model.row_upper()[row]);
    constraint_of_row_.push_back(bounded && !model.variables_of(row).empty() ? static_cast<int>(constraints_.size())
                                                                             : -1);
    Vector x = problem_.initial_guess(model.variables_of(row)), gradient(x.size());
    model.evaluate(row, x.data(), gradient.data(), nullptr);
    const double largest = x.size() > 0 ? gradient.lpNorm<Eigen::Infinity>() : 0.0;
    row_scale_.push_back(largest > largest_derivative && std::isfinite(largest) ? largest_derivative / largest : 1.0);
    if (constraint_of_row_.back() >= 0) constraints_.push_back(std::make_unique<NlRow>(model, row, row_scale_.back()));
  }
  if (model.has_objective() && !model.variables_of(NlModel::objective).empty()) {
    if (terms.empty()) {
      check_width(model, NlModel::objective, "the objective");
      energies_.push_back(std::make_unique<NlObjective>(model));
    }
    std::map<std::size_t, NlTerms*> by_width;
    for (NlTerm& term : terms) {
      NlTerms*& same = by_width[term.variables.size()];
      if (!same) {
        auto made = std::make_unique<NlTerms>(static_cast<int>(term.variables.size()), sign);
        same = made.get();
        energies_.push_back(std::move(made));
      }
      same->add(std::move(term));
    }
    Vector x = problem_.initial_guess(model.variables_of(NlModel::objective)), gradient(x.size());
    model.evaluate(NlModel::objective, x.data(), gradient.data(), nullptr);
    const double largest = gradient.lpNorm<Eigen::Infinity>();
    // Forces may all vanish at the solution of a general problem: their size at the start is the measure then.
    problem_.least_force_scale = largest > 0 && std::isfinite(largest) ? std::min(1.0, largest) : 1.0;
  }
  for (const auto& energy : energies_) problem_.energies.push_back(energy.get());
  for (const auto& constraint : constraints_) problem_.constraints.push_back(constraint.get());
}

NlProblem::~NlProblem() = default;

double NlProblem::objective(const Vector& x) const {
  return model_.has_objective() ? model_.value_at(NlModel::objective, x) : 0.0;
}

double NlProblem::objective_force(const Vector& x) const {
  if (energies_.empty()) return 1;
  const std::vector<int>& own = model_.variables_of(NlModel::objective);
  Vector gradient(static_cast<Index>(own.size()));
  model_.evaluate(NlModel::objective, Vector(x(own)).data(), gradient.data(), nullptr);
  return std::max(gradient.lpNorm<Eigen::Infinity>(), problem_.least_force_scale);
}

std::string NlProblem::name_of(const std::string& node) const {
  const std::string prefix = "vertex ";
  return node.starts_with(prefix) ? "variable " + model_.variable_name(std::stoi(node.substr(prefix.size()))) : node;
}

Vector NlProblem::dual(const Result& result) const {
  Vector dual = Vector::Zero(model_.rows());
  const double sign = model_.maximise() ? 1 : -1;
  for (std::size_t row = 0; row < constraint_of_row_.size(); ++row) {
    if (constraint_of_row_[row] < 0) continue;
    dual[static_cast<Index>(row)] =
        sign * row_scale_[row] * result.multipliers[static_cast<std::size_t>(constraint_of_row_[row])][0];
  }
  return dual;
}

WarmStart NlProblem::warm() const {
  WarmStart warm;
  const Vector& dual = model_.start_dual();
  if (dual.isZero(0)) return warm;
  for (const auto& constraint : constraints_)
    warm.multipliers.push_back(Vector::Zero(constraint->stencils().count() * constraint->rows()));
  const double sign = model_.maximise() ? 1 : -1;
  for (std::size_t row = 0; row < constraint_of_row_.size(); ++row) {
    if (constraint_of_row_[row] >= 0)
      warm.multipliers[static_cast<std::size_t>(constraint_of_row_[row])][0] =
          sign * dual[static_cast<Index>(row)] / row_scale_[row];
  }
  return warm;
}

}  // namespace taut
