#include "study/lean_runs.h"

#include <limits>

namespace taut {

std::optional<std::size_t> LeanRuns::find(const Levels& levels) const {
  for (std::size_t k = 0; k < outcome_.rungs.size(); ++k)
    if (outcome_.rungs[k].levels == levels) return k;
  return {};
}

std::size_t LeanRuns::run(const Levels& levels, long max_solves) {
  if (const auto before = find(levels)) return *before;
  if (runner_.interrupted() || runner_.out_of_time()) throw LeanHalt{};
  LeanRung done = runner_.run(levels, max_solves > 0 ? max_solves : costs_.allowed_solves(levels));
  if (done.status != "solved" && (runner_.interrupted() || runner_.out_of_time())) throw LeanHalt{};
  done.levels = levels;
  costs_.learn(outcome_.rungs, done);
  outcome_.rungs.push_back(std::move(done));
  return outcome_.rungs.size() - 1;
}

std::optional<double> LeanRuns::change_by_residual(std::size_t coarse, const Levels& finer) {
  if (!runner_.estimate || !outcome_.rungs[coarse].answer) return {};
  if (runner_.interrupted() || runner_.out_of_time()) throw LeanHalt{};
  ResidualTrial trial = runner_.estimate(outcome_.rungs[coarse], finer);
  trial.from = coarse;
  if (trial.answer) trial.change = distance(*outcome_.rungs[coarse].answer, *trial.answer);
  outcome_.residual_trials.push_back(trial);
  return trial.change;
}

double LeanRuns::between(std::size_t a, std::size_t b) {
  const std::optional<Answer>&first = outcome_.rungs[a].answer, &second = outcome_.rungs[b].answer;
  return first && second ? distance(*first, *second) : std::numeric_limits<double>::infinity();
}

/// The sum of the levels of all refinements.
int LeanRuns::coarseness(const Levels& levels) const {
  int sum = 0;
  for (std::size_t k = 0; k < levels.size(); ++k)
    if (ladder_.simplifications[k].refines()) sum += levels[k];
  return sum;
}

double LeanRuns::allowed() {
  const LeanRung* finest = nullptr;
  for (const LeanRung& one : outcome_.rungs)
    if (one.answer && (!finest || coarseness(one.levels) < coarseness(finest->levels))) finest = &one;
  outcome_.magnitude = finest ? finest->answer->magnitude : 0;
  outcome_.allowed = tolerance_.allowed(outcome_.magnitude);
  return outcome_.allowed;
}

}  // namespace taut
