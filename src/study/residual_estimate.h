#pragma once

#include <optional>
#include <string>

#include "problems/scene.h"
#include "study/quantity_of_interest.h"
#include "study/stored_run.h"

namespace taut {

/// What a finer model would answer, had it been run.
struct ResidualEstimate {
  std::optional<Answer> answer;  ///< nothing where it is not to be trusted
  std::string why;               ///< it is not
  double contraction = 0;        ///< Theta, below
  long linear_solves = 0;        ///< with one factorisation
  double work = 0;               ///< its flops
  double seconds = 0;            ///< by the clock
};

/// The answer of a static model without running it, from the residual r that the answer of a coarser model leaves in
/// its equations at full load. The coarse displacement is interpolated to the finer mesh, x; the Newton step
/// d = -H(x)^-1 r(x) and the simplified one e = -H(x)^-1 r(x + d) with the same factor [Deuflhard 2004, 2.1] lead to
/// x + d + e, whose answer is taken. To first order its distance from the coarse answer is the dual-weighted residual
/// of the embedded mesh [Venditti and Darmofal 2000; Becker and Rannacher 2001].
///
/// It is trusted where Theta = |e| / |d| is at most largest_contraction, or e is nothing against the displacement: what
/// is left is of the order of Theta^2 |d|. It is not where the stiffness is not positive definite, where a constraint
/// holds or would be violated, and never with linear equalities, modes, loads that depend on the step before, or
/// natural frequencies, or where the two models have other bodies or layers. Pins are kept exactly.
///
/// Throws InputError where the finer scene cannot be built.
ResidualEstimate residual_estimate(const StoredRun& coarse, const Scene& finer, const Observer& observer, int threads);

inline constexpr double largest_contraction = 0.25;

}  // namespace taut
