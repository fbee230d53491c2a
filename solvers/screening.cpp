#include <algorithm>

#include "solvers/augmented_lagrangian_run.h"

namespace taut {

/// Leaves out the elements that were inactive, where the initial guess is nearer to the boundary by no less than
/// `screening` times the largest change of any element in the last solve. That is a guess, not a bound: solve() looks.
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
