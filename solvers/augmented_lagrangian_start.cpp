#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "solvers/augmented_lagrangian_run.h"

namespace taut {
namespace {

/// Replaces `projected` by the multipliers of `slack`, but zero in elements where `projected` is zero and the norm is
/// below 1e-6 of the largest.
void keep_significant(const EliminatedSlack& slack, Vector& projected) {
  const Vector& own = slack.multipliers();
  const int rows = slack.constraint().rows();
  double largest = 0;
  for (Index first = 0; first < own.size(); first += rows) largest = std::max(largest, own.segment(first, rows).norm());
  for (Index first = 0; first < own.size(); first += rows) {
    const bool negligible =
        projected.segment(first, rows).isZero(0) && own.segment(first, rows).norm() <= 1e-6 * largest;
    if (!negligible) projected.segment(first, rows) = own.segment(first, rows);
  }
}

/// One entry on the diagonal of an element's Hessian.
struct Stiffness {
  int variable;
  double value;
};

std::vector<Stiffness> diagonals_of_energies(const Problem& problem, const Vector& x) {
  std::vector<Stiffness> diagonals;
  for (const Energy* energy : problem.energies) {
    if (!energy->has_curvature()) continue;
    const Stencils& stencils = energy->stencils();
    const int width = stencils.width();
    Vector local(width), gradient(width), hessian(width * width);
    for (Index element = 0; element < stencils.count(); ++element) {
      stencils.gather(element, x, local.data());
      energy->evaluate(element, local.data(), gradient.data(), hessian.data(), Curvature::positive_semidefinite);
      for (int k = 0; k < width; ++k) diagonals.push_back({stencils[element][k], hessian[k * width + k]});
    }
  }
  return diagonals;
}

/// The ratio of the diagonals that energies and this constraint's J^T w J put on the variables it touches: the penalty
/// at which both are equally stiff.
double automatic_penalty(const Constraint& constraint, const Problem& problem, const Vector& x,
                         const std::vector<Stiffness>& diagonals) {
  Vector touched = Vector::Zero(problem.size());
  const Stencils& stencils = constraint.stencils();
  Vector local(stencils.width()), jacobian(constraint.rows() * stencils.width());
  std::array<double, max_rows> c;
  for (Index element = 0; element < stencils.count(); ++element) {
    stencils.gather(element, x, local.data());
    constraint.evaluate(element, local.data(), c.data(), jacobian.data());
    for (int k = 0; k < stencils.width(); ++k) {
      const double square =
          Eigen::Map<const Vector>(jacobian.data() + k * constraint.rows(), constraint.rows()).squaredNorm();
      touched[stencils[element][k]] += constraint.weight(element) * square;
    }
  }
  for (int variable : problem.fixed_variables) touched[variable] = 0;
  double stiffness = 0;
  for (const Stiffness& diagonal : diagonals) {
    if (touched[diagonal.variable] > 0) stiffness += diagonal.value;
  }
  const double rows = touched.sum();
  return rows > 0 && stiffness > 0 && std::isfinite(stiffness / rows) ? stiffness / rows : 1.0;
}

}  // namespace

void AugmentedLagrangian::Run::start(const WarmStart& warm) {
  result.x = problem.initial_guess;
  for (std::size_t i = 0; i < problem.fixed_variables.size(); ++i) {
    result.x[problem.fixed_variables[i]] = problem.fixed_values[static_cast<Index>(i)];
  }
  std::optional<std::vector<Stiffness>> diagonals;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    EliminatedSlack& slack = work.slacks[k];
    slack.take_all_in();
    const Index rows = slack.multipliers().size();
    slack.set_multipliers(options.warm_multipliers && k < warm.multipliers.size() ? warm.multipliers[k]
                                                                                  : Vector(Vector::Zero(rows)));
    double penalty = options.fixed_penalty;
    if (penalty == 0 && k < warm.penalties.size()) penalty = warm.penalties[k];
    if (!(penalty > 0)) {
      if (!diagonals) diagonals = diagonals_of_energies(problem, result.x);
      penalty = options.penalty * automatic_penalty(slack.constraint(), problem, result.x, *diagonals);
    }
    slack.set_penalty(penalty);
    start_penalty.push_back(penalty);
    result.multipliers.push_back(slack.multipliers());
    result.penalties.push_back(penalty);
  }
  work.equalities.update(problem);
  const Vector equal = work.equalities.stacked(warm.multipliers, work.slacks.size());
  work.equalities.put(options.warm_multipliers ? equal : Vector(Vector::Zero(equal.size())), work.slacks.size(),
                      result.multipliers);
  // Of the start only the scale of its forces is wanted, and the last step's is as good.
  if (warm.force_scale > 0 && std::isfinite(warm.force_scale) && !work.slacks.empty()) {
    judged.force_scale = warm.force_scale;
  } else {
    judged = residuals(problem, result);
  }
}

/// Tries the central path from `result`; on success `result` and `judged` hold the solution, else they are restored.
bool AugmentedLagrangian::Run::central_path() {
  if (!options.central_path.enabled || !constrained()) return false;
  const Result start = result;
  const Residuals start_judged = judged;
  std::vector<double> penalties;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    penalties.push_back(work.slacks[k].penalty());
    work.slacks[k].set_penalty(options.central_path.penalty_fraction * start_penalty[k]);
  }
  Vector x = result.x, equal = work.equalities.stacked(result.multipliers, work.slacks.size());
  const bool solved = follow_central_path(
      work.assembly, *work.system, work.equalities, work.slacks, problem.fixed_variables, problem.node_size,
      judged.force_scale, options.tolerances, options.central_path, options.threads, x, equal,
      [&](const Vector& candidate) {
        result.x = candidate;
        const Judge judge(problem, result.x);
        // Projected multipliers vanish where a constraint is not active; the path's own are positive everywhere, but
        // where many are weak their forces balance better, so they come second, without those that are negligible.
        for (std::size_t k = 0; k < work.slacks.size(); ++k) {
          work.slacks[k].updated_multipliers(candidate, std::numeric_limits<double>::infinity(), result.multipliers[k]);
        }
        work.equalities.put(equal, work.slacks.size(), result.multipliers);
        judged = judge(result.multipliers);
        if (judged.within(options.tolerances)) return judged.over(options.tolerances);
        for (std::size_t k = 0; k < work.slacks.size(); ++k) keep_significant(work.slacks[k], result.multipliers[k]);
        judged = judge(result.multipliers);
        if (!options.newton_finish || judged.within(options.tolerances)) return judged.over(options.tolerances);
        using Linearisation = EliminatedSlack::Linearisation;
        for (EliminatedSlack& slack : work.slacks) slack.set_linearisation(Linearisation::augmented_lagrangian);
        const bool finished = newton_finish();
        for (EliminatedSlack& slack : work.slacks) slack.set_linearisation(Linearisation::central_path);
        if (!finished) work.assembly.hessian(candidate, Curvature::positive_semidefinite);  // the path's again
        return judged.over(options.tolerances);
      },
      observer ? [&](const Vector& now) { show(now, equal); } : std::function<void(const Vector&)>(), budget,
      result.counts, result.timings);
  for (std::size_t k = 0; k < work.slacks.size(); ++k) work.slacks[k].set_penalty(penalties[k]);
  if (solved) return true;
  result.x = start.x;
  result.multipliers = start.multipliers;
  judged = start_judged;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) work.slacks[k].set_multipliers(start.multipliers[k]);
  return false;
}

}  // namespace taut
