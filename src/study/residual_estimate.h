#pragma once

#include <optional>
#include <string>

#include "problems/scene.h"
#include "study/quantity_of_interest.h"
#include "study/stored_run.h"

namespace taut {

/// What a finer model would answer, without running it.
struct ResidualEstimate {
  std::optional<Answer> answer;  ///< nothing where it is not to be trusted
  std::string why;               ///< it is not
  long linear_solves = 0;
  double work = 0, seconds = 0, contraction = 0;  ///< flops of the factorisation
  std::optional<Answer> first;
};

ResidualEstimate residual_estimate(const StoredRun& coarse, const Scene& finer, const Observer& observer, int threads);

}  // namespace taut
