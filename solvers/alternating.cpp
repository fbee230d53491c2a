#include "solvers/alternating.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "core/stopwatch.h"

namespace taut {
namespace {

/// Of a row's penalty against its stiffness. Measured on compressed_sheet and quilt: 0.1 takes twice the rounds, 3 five
/// to ten times.
constexpr double softness = 0.3;

/// sum_i nu_i s_i + mu_i/2 s_i^2 of the variables s from `first` on.
class RowPenalty final : public Energy {
 public:
  RowPenalty(Index first, Index count) : multipliers(Vector::Zero(count)), penalties(Vector::Ones(count)) {
    for (Index i = 0; i < count; ++i) stencils_.add(std::array{static_cast<int>(first + i)});
  }
  std::string name() const override { return "penalty of the coupling"; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian, Curvature) const override {
    const double force = penalties[element] * *x;
    if (gradient) *gradient = multipliers[element] + force;
    if (hessian) *hessian = penalties[element];
    return (multipliers[element] + 0.5 * force) * *x;
  }

  Vector multipliers, penalties;

 private:
  Stencils stencils_{1};
};

bool touches(const Constraint& constraint, const std::vector<char>& held) {
  const Stencils& stencils = constraint.stencils();
  for (Index element = 0; element < stencils.count(); ++element) {
    for (int k = 0; k < stencils.width(); ++k) {
      if (!held[static_cast<std::size_t>(stencils[element][k])]) return true;
    }
  }
  return false;
}

/// Variables of the sides that follow.
std::vector<char> following(const Problem& problem) {
  std::vector<char> follows(static_cast<std::size_t>(problem.size()), 0);
  for (const LinearEqualities* equal : problem.equalities) {
    if (equal->following.empty())
      throw std::invalid_argument("Alternating: " + equal->name + " does not say which of its variables follow");
    for (const int variable : equal->following) follows[static_cast<std::size_t>(variable)] = 1;
  }
  return follows;
}

/// The stiffness 1/(a diag(H)^-1 a^T) of each row, as the positive semidefinite H at the initial guess has it.
Vector row_stiffness(const Problem& problem, const EqualityRows& equalities) {
  Assembly assembly(problem.size(), problem.energies, {}, 1);
  assembly.hessian(problem.initial_guess, Curvature::positive_semidefinite);
  Vector diagonal;
  assembly.from_ordered(assembly.matrix().diagonal(), diagonal);
  const double smallest = 1e-12 * diagonal.maxCoeff();
  return (equalities.rows().cwiseAbs2() * diagonal.cwiseMax(smallest).cwiseInverse()).cwiseInverse();
}

}  // namespace

/// One side of the coupling, the other held: min f + nu . s + 1/2 sum mu s^2 with A x - s = b.
class Alternating::Half {
 public:
  Half(const Problem& problem, const EqualityRows& equalities, const std::vector<char>& held,
       const AugmentedLagrangianOptions& options)
      : penalty(problem.size(), equalities.count()), posed_(problem), solver_(options) {
    const Index n = problem.size(), m = equalities.count();
    std::vector<char> fixed = held;
    for (const int variable : problem.fixed_variables) fixed[static_cast<std::size_t>(variable)] = 1;
    posed_.fixed_variables.clear();
    for (int i = 0; i < static_cast<int>(n); ++i) {
      if (fixed[static_cast<std::size_t>(i)]) posed_.fixed_variables.push_back(i);
    }
    posed_.constraints.clear();
    for (std::size_t k = 0; k < problem.constraints.size(); ++k) {
      if (!touches(*problem.constraints[k], fixed)) continue;
      posed_.constraints.push_back(problem.constraints[k]);
      own_.push_back(k);
    }
    rows_.name = "coupling";
    rows_.rows.resize(m, n + m);
    std::vector<Eigen::Triplet<double>> entries;
    for (Index column = 0; column < n; ++column) {
      for (SparseMatrix::InnerIterator entry(equalities.rows(), column); entry; ++entry)
        entries.emplace_back(static_cast<int>(entry.row()), static_cast<int>(column), entry.value());
    }
    for (Index i = 0; i < m; ++i) entries.emplace_back(static_cast<int>(i), static_cast<int>(n + i), -1.0);
    rows_.rows.setFromTriplets(entries.begin(), entries.end());
    rows_.violation_scale = problem.equalities.front()->violation_scale;
    rows_.row_name = [](Index row) { return "row " + std::to_string(row); };
    posed_.energies.push_back(&penalty);
    posed_.equalities = {&rows_};
    posed_.topology = new_topology();
  }

  /// Moves result.x, and replaces the multipliers and penalties of this half's constraints; nu + mu (A x - b) is then
  /// in `force`.
  Status solve(const EqualityRows& equalities, Result& result, const Budget& budget, Vector& force) {
    const Index n = result.x.size(), m = equalities.count();
    Vector violation;
    equalities.violation(result.x, violation);
    posed_.initial_guess.resize(n + m);
    posed_.initial_guess << result.x, violation;
    posed_.fixed_values.resize(static_cast<Index>(posed_.fixed_variables.size()));
    for (std::size_t i = 0; i < posed_.fixed_variables.size(); ++i)
      posed_.fixed_values[static_cast<Index>(i)] = result.x[posed_.fixed_variables[i]];
    rows_.values = equalities.values();
    WarmStart warm;
    for (const std::size_t k : own_) {
      warm.multipliers.push_back(result.multipliers[k]);
      warm.penalties.push_back(result.penalties[k]);
    }
    warm.multipliers.push_back(penalty.multipliers + penalty.penalties.cwiseProduct(violation));
    Result half = solver_.solve(posed_, warm, budget);
    result.x = half.x.head(n);
    for (std::size_t i = 0; i < own_.size(); ++i) {
      result.multipliers[own_[i]] = half.multipliers[i];
      result.penalties[own_[i]] = half.penalties[i];
    }
    force = half.multipliers.back();
    const long rounds = result.counts.outer;
    result.counts += half.counts;
    result.counts.outer = rounds;
    result.timings += half.timings;
    return half.status;
  }

  RowPenalty penalty;

 private:
  Problem posed_;
  std::vector<std::size_t> own_;  // constraints of the whole problem
  LinearEqualities rows_;
  AugmentedLagrangian solver_;
};

struct Alternating::Workspace {
  std::uint64_t topology;
  EqualityRows equalities;
  Vector penalties;
  std::unique_ptr<Half> leading, following_half;

  Workspace(const Problem& problem, const AugmentedLagrangianOptions& options)
      : topology(problem.topology), equalities(problem), penalties(softness * row_stiffness(problem, equalities)) {
    std::vector<char> follows = following(problem);
    leading = std::make_unique<Half>(problem, equalities, follows, options);
    for (char& one : follows) one = !one;
    following_half = std::make_unique<Half>(problem, equalities, follows, options);
  }
};

Alternating::Alternating(AugmentedLagrangianOptions options) : options_(options) { options_.validate(); }
Alternating::~Alternating() = default;

void Alternating::rounds(const Problem& problem, const Budget& budget, Result& result) {
  Workspace& work = *workspace_;
  work.equalities.update(problem);
  const std::size_t constraints = problem.constraints.size();
  for (std::size_t k = 0; k < constraints; ++k) {
    const Constraint& constraint = *problem.constraints[k];
    const Index rows = constraint.stencils().count() * constraint.rows();
    if (result.multipliers[k].size() != rows) result.multipliers[k].setZero(rows);
  }
  Vector force = work.equalities.stacked(result.multipliers, constraints), unused;
  while (true) {
    for (Half* half : {work.leading.get(), work.following_half.get()}) {
      half->penalty.multipliers = force;
      half->penalty.penalties = work.penalties;
    }
    work.leading->solve(work.equalities, result, budget, unused);
    const Status status = work.following_half->solve(work.equalities, result, budget, force);
    work.equalities.put(force, constraints, result.multipliers);
    ++result.counts.outer;
    if (observer) observer({result.x, result.multipliers, 0, result.counts});
    const Residuals judged = residuals(problem, result);
    const auto finish = [&](Status ended, const char* message) {
      result.status = ended;
      result.message = message;
    };
    if (judged.within(options_.tolerances)) return finish(Status::solved, "residuals within tolerance");
    if (!judged.finite) return finish(Status::not_finite, "a position or a force is not finite");
    if (status == Status::interrupted || budget.interrupted()) return finish(Status::interrupted, "stopped on request");
    if (budget.out_of_time()) return finish(Status::time_limit, "out of time");
    if (result.counts.outer >= options_.max_outer) return finish(Status::iteration_limit, "rounds used up");
  }
}

Result Alternating::solve(const Problem& problem, const WarmStart& warm, const Budget& budget) {
  if (problem.equalities.empty()) throw std::invalid_argument("Alternating: expected equalities, found none");
  Result result;
  double total = 0;
  {
    const Stopwatch watch(total);
    if (!workspace_ || workspace_->topology == 0 || workspace_->topology != problem.topology) {
      problem.validate();
      AugmentedLagrangianOptions half = options_;
      for (double* tolerance :
           {&half.tolerances.stationarity, &half.tolerances.feasibility, &half.tolerances.complementarity})
        *tolerance *= 0.3;
      workspace_ = std::make_unique<Workspace>(problem, half);
    }
    result.x = problem.initial_guess;
    for (std::size_t i = 0; i < problem.fixed_variables.size(); ++i)
      result.x[problem.fixed_variables[i]] = problem.fixed_values[static_cast<Index>(i)];
    result.multipliers = warm.multipliers;
    result.multipliers.resize(problem.constraints.size() + problem.equalities.size());
    result.penalties = warm.penalties;
    result.penalties.resize(problem.constraints.size(), 0);
    rounds(problem, budget, result);
  }
  result.timings.total = total;
  return result;
}

}  // namespace taut
