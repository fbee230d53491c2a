#include "study/lean_costs.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

constexpr double fewest_allowed = 100;  // linear solves: a model of one load step may take that many

LeanCosts::LeanCosts(const LeanLadder& ladder) : ladder_(ladder) {
  for (const Simplification& one : ladder.simplifications) ratio_.push_back(one.cost_ratio);
}

double LeanCosts::saving(const Levels& levels) const {
  double product = 1;
  for (std::size_t k = 0; k < levels.size(); ++k)
    if (ladder_.simplifications[k].refines()) product *= std::pow(ratio_[k], levels[k]);
  return product;
}

int LeanCosts::worthwhile_level(std::size_t k) const {
  if (ratio_[k] <= 1) return std::numeric_limits<int>::max();
  return static_cast<int>(std::ceil(std::log(least_saving) / std::log(ratio_[k]) - 1e-9));
}

long LeanCosts::allowed_solves(const Levels& levels) const {
  if (is_full(levels) || ladder_.full_linear_solves == 0) return 0;
  double solves = ladder_.full_linear_solves / least_saving;
  for (std::size_t k = 0; k < levels.size(); ++k) solves *= std::pow(ladder_.simplifications[k].solve_ratio, levels[k]);
  return std::lround(std::max(fewest_allowed, solves));
}

double LeanCosts::full_seconds(const LeanRung& rung) const {
  double seconds = rung.seconds;
  for (std::size_t k = 0; k < rung.levels.size(); ++k)
    if (ladder_.simplifications[k].refines())
      seconds *= std::pow(ladder_.simplifications[k].cost_ratio, rung.levels[k]);
  return seconds;
}

void LeanCosts::learn(const std::vector<LeanRung>& before, const LeanRung& now) {
  if (!now.answer || now.work == 0) return;
  for (auto last = before.rbegin(); last != before.rend(); ++last) {
    int levels = 0;
    bool coarser = last->answer && last->work > 0;
    for (std::size_t k = 0; k < ratio_.size(); ++k) {
      if (!ladder_.simplifications[k].refines()) continue;
      coarser = coarser && last->levels[k] >= now.levels[k];
      levels += last->levels[k] - now.levels[k];
    }
    if (!coarser || levels == 0) continue;
    const double expected = saving(last->levels) / saving(now.levels),
                 correction = std::pow(now.work / last->work / expected, 1.0 / levels);
    for (std::size_t k = 0; k < ratio_.size(); ++k)
      if (ladder_.simplifications[k].refines() && last->levels[k] > now.levels[k])
        ratio_[k] = std::max(1.0, correction * ratio_[k]);
    return;
  }
}

}  // namespace taut
