#include "study/lean_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace taut {

void LeanErrors::compare(double estimated, double measured) {
  if (std::isfinite(measured) && estimated > 0) pessimism_ *= std::max(1.0, measured / estimated);
}

double LeanErrors::estimate(const Levels& levels) const {
  double sum = of_omissions(levels);
  for (std::size_t k = 0; k < levels.size(); ++k)
    if (ladder_.simplifications[k].refines()) sum += of_refinement(k, levels[k]);
  return pessimism_ * sum;
}

Levels LeanErrors::omissions_in(const Levels& levels) const {
  Levels part = levels;
  for (std::size_t k = 0; k < part.size(); ++k)
    if (ladder_.simplifications[k].refines()) part[k] = 0;
  return part;
}

double LeanErrors::of_omissions(const Levels& levels) const {
  const Levels part = omissions_in(levels);
  if (is_full(part)) return 0;
  const auto found = changes_.find(part);
  return found == changes_.end() ? std::numeric_limits<double>::infinity() : found->second;
}

}  // namespace taut
