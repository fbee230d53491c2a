#pragma once

namespace taut {

/// The largest fraction of the step dx of a triangle (nine coordinates each) after which its area, projected on its
/// present plane, is still a tenth of what it is now; infinity where no fraction up to 2 is seen to violate that. It
/// keeps a line search from carrying a triangle through collapse to its mirror image.
double step_before_collapse(const double* x, const double* dx);

}  // namespace taut
