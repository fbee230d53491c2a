#pragma once

#include <optional>
#include <vector>

#include "core/types.h"

namespace taut {

/// Newmark's method as a recursion (MW (A.8)-(A.11)): what a receiver of accelerations needs to know.
struct NewmarkRule {
  double step = 0.01;  ///< h, s
  double beta = 0.25, gamma = 0.5;
};

/// Spectral displacement, velocity and acceleration.
struct SpectralState {
  Vector q, v, a;
};

/// The state one step later, when its acceleration is `a`.
SpectralState newmark_step(const NewmarkRule& rule, const SpectralState& state, const Vector& a);

/// What stands in for an acceleration that did not arrive: nothing; the last one that did; or the straight line through
/// the last two that did, where they are.
enum class Fill { zero, hold, linear };

/// Rebuilds a trajectory from accelerations (MW appendix B), some of which may be missing.
class Replay {
 public:
  Replay(NewmarkRule rule, SpectralState start, Fill fill);

  const SpectralState& state() const { return state_; }
  /// Goes one step on with its acceleration, or without. Throws std::invalid_argument for one of another size.
  void advance(const std::optional<Vector>& acceleration);
  /// Takes a whole state in place of its own (a keyframe): all distortions end here.
  void correct(SpectralState state);
  /// The acceleration that would be used for the next step if it did not arrive.
  Vector predicted() const;

 private:
  NewmarkRule rule_;
  SpectralState state_;
  Fill fill_;
  Vector last_, before_last_;  // that arrived; empty: none yet
  int since_ = 0, apart_ = 1;  // steps since the last one, and from the one before to it
};

/// Distortions that one loss at step t causes when what stands in for it is off by one unit of acceleration, at steps
/// t, t + 1, ..., t + count - 1, over h^2 and over h: beta, then gamma + 1/2 + (k - 1); gamma, then 1. The lemma and
/// theorem of MW (A.18)-(A.25) are those of beta = 1/4, gamma = 1/2. Losses superpose.
struct LossLaw {
  std::vector<double> displacement, velocity;
};
LossLaw loss_law(const NewmarkRule& rule, int count);

}  // namespace taut
