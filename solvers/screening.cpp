#include "solvers/augmented_lagrangian_run.h"

namespace taut {

/// Leaves out the constraints that were inactive, where no element of the initial guess is nearer to its boundary than
/// `screening` times the largest change of any element in the last solve. That is a guess, not a bound: solve() looks.
void AugmentedLagrangian::Run::leave_out(const WarmStart& warm) {
  if (options.screening == 0 || warm.changes.size() != work.slacks.size()) return;
  for (std::size_t k = 0; k < work.slacks.size(); ++k) {
    EliminatedSlack& slack = work.slacks[k];
    if (!slack.multipliers().isZero(0) || !slack.is_far_inside(result.x, options.screening * warm.changes[k])) continue;
    slack.set_left_out(true);
    ++left_out;
  }
}

/// True where `judged` has found a constraint violated that was left out, by however little.
bool AugmentedLagrangian::Run::left_out_violated() const {
  for (std::size_t k = 0; left_out > 0 && k < work.slacks.size(); ++k) {
    if (work.slacks[k].left_out() && !(judged.violations[k].max <= 0)) return true;
  }
  return false;
}

void AugmentedLagrangian::Run::solve(const WarmStart& warm) {
  start(warm);
  const Vector guess = result.x;
  leave_out(warm);
  result.counts.screened = left_out;
  loop();
  const bool cut_off = result.status == Status::interrupted || result.status == Status::time_limit;
  if (left_out > 0 && !cut_off && (result.status != Status::solved || left_out_violated())) {
    // The point with its constraints back is what a solve without screening would start from.
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
