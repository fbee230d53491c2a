#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/scratch.h"
#include "solvers/augmented_lagrangian_run.h"

namespace taut {
namespace {

using Rows = std::array<double, max_rows>;

}  // namespace

Index EliminatedSlack::leave_out(const Vector& x, double radius) {
  const int rows = constraint_.rows();
  Scratch<max_stencil_width> local(stencils().width());
  Rows c;
  take_all_in();
  for (Index element = 0; element < stencils().count(); ++element) {
    if (!multipliers_.segment(element * rows, rows).isZero(0)) continue;
    stencils().gather(element, x, local.data());
    constraint_.evaluate(element, local.data(), c.data(), nullptr);
    if (!constraint_.set().contains_ball(element, c.data(), radius)) continue;
    left_out_[static_cast<std::size_t>(element)] = 1;
    ++left_out_count_;
  }
  return left_out_count_;
}

void EliminatedSlack::take_all_in() {
  std::fill(left_out_.begin(), left_out_.end(), 0);
  left_out_count_ = 0;
}

bool EliminatedSlack::left_out_violated(const Vector& x) const {
  Scratch<max_stencil_width> local(stencils().width());
  for (Index element = 0; left_out_count_ > 0 && element < stencils().count(); ++element) {
    if (!left_out(element)) continue;
    stencils().gather(element, x, local.data());
    if (!(constraint_.violation(element, local.data()) <= 0)) return true;
  }
  return false;
}

double EliminatedSlack::largest_change(const Vector& from, const Vector& to) const {
  Scratch<max_stencil_width> local(stencils().width());
  Rows before, after;
  double largest = 0;
  for (Index element = 0; element < stencils().count(); ++element) {
    stencils().gather(element, from, local.data());
    constraint_.evaluate(element, local.data(), before.data(), nullptr);
    stencils().gather(element, to, local.data());
    constraint_.evaluate(element, local.data(), after.data(), nullptr);
    double square = 0;
    for (int i = 0; i < constraint_.rows(); ++i) square += (after[i] - before[i]) * (after[i] - before[i]);
    if (!std::isfinite(square)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, square);
  }
  return std::sqrt(largest);
}

/// Leaves out the elements that were inactive and of which the initial guess keeps more than `screening` times the
/// largest change of any element in the last solve to the boundary. That is a guess, not a bound: solve() looks.
void AugmentedLagrangian::Run::leave_out(const WarmStart& warm) {
  if (options.screening == 0 || warm.changes.size() != work.slacks.size()) return;
  for (std::size_t k = 0; k < work.slacks.size(); ++k)
    left_out += work.slacks[k].leave_out(result.x, options.screening * warm.changes[k]);
}

/// True where the result violates something that was left out, by however little.
bool AugmentedLagrangian::Run::left_out_violated() const {
  return left_out > 0 && std::any_of(work.slacks.begin(), work.slacks.end(),
                                     [&](const EliminatedSlack& slack) { return slack.left_out_violated(result.x); });
}

bool AugmentedLagrangian::Run::constrained() const {
  return std::any_of(work.slacks.begin(), work.slacks.end(),
                     [](const EliminatedSlack& slack) { return !slack.is_left_out(); });
}

void AugmentedLagrangian::Run::solve(const WarmStart& warm) {
  start(warm);
  const Vector guess = result.x;
  leave_out(warm);
  result.counts.screened = left_out;
  loop();
  const bool cut_off = result.status == Status::interrupted || result.status == Status::time_limit;
  if (!cut_off && left_out_violated()) {
    before_again = result.counts;
    left_out = 0;
    result.multipliers.clear();
    result.penalties.clear();
    start_penalty.clear();
    start(warm);
    ++result.counts.screening_failures;
    result.counts.screened = 0;
    loop();
  }
  for (const EliminatedSlack& slack : work.slacks) result.changes.push_back(slack.largest_change(guess, result.x));
}

}  // namespace taut
