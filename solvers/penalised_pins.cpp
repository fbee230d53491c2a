#include "solvers/penalised_pins.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace taut {
namespace {

/// K = {0} in R.
class Zero final : public ConvexSet {
 public:
  int dimension() const override { return 1; }
  void project(Index /*element*/, const double* z, double* nearest, double* derivative) const override {
    *nearest = std::isnan(*z) ? *z : 0;
    if (derivative) *derivative = 0;
  }
  void project_smoothed(Index /*element*/, const double* z, double /*epsilon*/, double* nearest, double* inverse,
                        double* rate) const override {
    *nearest = std::isnan(*z) ? *z : 0;
    *inverse = 1e8;
    *rate = 0;
  }
  int smooth_rows() const override { return 1; }
  void smooth_bounds(double* lower, double* upper) const override { *lower = *upper = 0; }
  void smooth_values(Index /*element*/, const double* c, double* g, double* jacobian) const override {
    *g = *c;
    if (jacobian) *jacobian = 1;
  }
  void smooth_hessian(Index /*element*/, const double* /*z*/, const double* /*weights*/,
                      double* hessian) const override {
    *hessian = 0;
  }
};

}  // namespace

class PenalisedPins::Rows final : public Constraint {
 public:
  explicit Rows(const Problem& problem) : node_size_(problem.node_size) {
    for (int variable : problem.fixed_variables) stencils_.add(std::array{variable});
  }
  void set_values(const Vector& values) {
    values_ = values;
    scale_ = std::max(values.lpNorm<Eigen::Infinity>(), 1e-300);  // as the judge measures pins
  }
  std::string name() const override { return "pins"; }
  const Stencils& stencils() const override { return stencils_; }
  int rows() const override { return 1; }
  const ConvexSet& set() const override { return set_; }
  void evaluate(Index element, const double* x, double* c, double* jacobian) const override {
    *c = *x - values_[element];
    if (jacobian) *jacobian = 1;
  }
  void hessian(Index /*element*/, const double* /*x*/, const double* /*multipliers*/, Curvature /*curvature*/,
               double* hessian) const override {
    *hessian = 0;
  }
  double violation(Index element, const double* x) const override { return std::abs(*x - values_[element]); }
  double violation_scale() const override { return scale_; }
  std::string element_name(Index element) const override {
    return "vertex " + std::to_string(stencils_[element][0] / node_size_);
  }

 private:
  Stencils stencils_{1};
  Zero set_;
  int node_size_;
  Vector values_;
  double scale_ = 1;
};

PenalisedPins::PenalisedPins(std::unique_ptr<Solver> inner, Tolerances tolerances)
    : inner_(std::move(inner)), tolerances_(tolerances) {}
PenalisedPins::~PenalisedPins() = default;

Result PenalisedPins::solve(const Problem& problem, const WarmStart& warm, const Budget& budget) {
  if (!rows_ || topology_ == 0 || topology_ != problem.topology) {
    rows_ = std::make_unique<Rows>(problem);
    topology_ = problem.topology;
    own_topology_ = new_topology();
  }
  rows_->set_values(problem.fixed_values);
  Problem posed = problem;
  posed.topology = own_topology_;
  posed.fixed_variables.clear();
  posed.fixed_values.resize(0);
  posed.constraints.push_back(rows_.get());
  // Those of equalities stand behind those of the rows.
  const auto own = static_cast<std::ptrdiff_t>(problem.constraints.size());
  WarmStart start = warm;
  if (start.multipliers.size() > problem.constraints.size()) {
    start.multipliers.insert(start.multipliers.begin() + own,
                             Vector::Zero(static_cast<Index>(problem.fixed_variables.size())));
  }
  Result result = inner_->solve(posed, start, budget);
  result.multipliers.erase(result.multipliers.begin() + own);
  result.penalties.resize(std::min(result.penalties.size(), problem.constraints.size()));
  if (result.status == Status::solved && !residuals(problem, result).within(tolerances_)) {
    result.status = Status::stalled;
    result.message = "solved with the pins as rows, but not to the tolerance of the problem itself";
  }
  return result;
}

}  // namespace taut
