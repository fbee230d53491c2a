#include "solvers/central_path.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <vector>

#include "core/stopwatch.h"
#include "solvers/newton.h"

namespace taut {
namespace {

using Linearisation = EliminatedSlack::Linearisation;

/// The iteration's data, so that its parts read as what they are.
class CentralPath {
 public:
  CentralPath(Assembly& assembly, Cholesky& cholesky, std::deque<EliminatedSlack>& slacks, int node_size,
              double force_scale, const CentralPathOptions& options, Counts& counts, Timings& timings)
      : assembly_(assembly),
        cholesky_(cholesky),
        slacks_(slacks),
        node_size_(node_size),
        force_scale_(force_scale),
        options_(options),
        counts_(counts),
        timings_(timings) {}

  /// Smoothing in proportion to how badly the warm-started multipliers fit.
  void start(const Vector& x) {
    set_width(1e-6);
    measure_mismatch(x);
    set_width(std::clamp(0.3 * mismatch_.worst, 1e-5, 0.1));
  }

  double width() const { return width_; }
  double force() const { return force_; }
  /// True after a dozen steps in a row that the merit function cut short: the path is lost.
  bool lost() const { return short_steps_ >= 12; }
  bool centred() const { return mismatch_.worst <= options_.centred * width_; }
  void reduce() { set_width(std::max(std::sqrt(options_.reduction) * width_, options_.smallest_width)); }

  /// Where x and the multipliers stand: sum of w J^T lambda and gradients, and the mismatch of the multipliers.
  double measure(const Vector& x) {
    const Stopwatch watch(timings_.assembly);
    ++counts_.function_evaluations;
    linearise(Linearisation::held);
    assembly_.gradient(x, gradient_);
    force_ = nodal_max_norm(gradient_, node_size_);
    measure_mismatch(x);
    gradient_square_ = gradient_.squaredNorm() / (force_scale_ * force_scale_);
    return mismatch_.mean_square + gradient_square_;
  }
  void measure_mismatch(const Vector& x) {
    mismatch_ = {};
    for (const EliminatedSlack& slack : slacks_) {
      const double scale = slack.constraint().violation_scale();
      const EliminatedSlack::Mismatch one = slack.mismatch(x);
      mismatch_.worst = std::max(mismatch_.worst, one.max / scale);
      mismatch_.mean_square += one.mean_square / (scale * scale);
    }
  }

  /// Solves for the step in x and the multipliers; false where the matrix is not positive definite.
  bool step(const Vector& x) {
    if (!(use_exact() && factorize(x, Curvature::exact))) {
      if (!factorize(x, Curvature::positive_semidefinite)) return false;
    }
    {
      const Stopwatch watch(timings_.solve);
      ++counts_.linear_solves;
      assembly_.to_ordered(gradient_, right_hand_side_);
      cholesky_.solve(right_hand_side_, solution_);
      assembly_.from_ordered(solution_, step_);
      step_ = -step_;
    }
    const Stopwatch watch(timings_.assembly);
    multiplier_steps_.resize(slacks_.size());
    start_multipliers_.clear();
    for (std::size_t k = 0; k < slacks_.size(); ++k) {
      slacks_[k].multiplier_step(x, step_, multiplier_steps_[k]);
      start_multipliers_.push_back(slacks_[k].multipliers());
      if (!multiplier_steps_[k].allFinite()) return false;
    }
    return step_.allFinite();
  }

  /// Halves the step until the merit falls, or takes the best fraction tried. Returns the merit there, measured.
  double advance(Vector& x, double merit) {
    double fraction = std::min(1.0, 0.9 * assembly_.largest_step(x, step_));
    double best_fraction = fraction, best = std::numeric_limits<double>::infinity();
    Vector trial;
    for (int halving = 0; halving < options_.max_halvings; ++halving) {
      if (halving > 0) fraction *= 0.5;
      trial = x + fraction * step_;
      set_multipliers(fraction);
      const double now = measure(trial);
      if (now < best) {
        best = now;
        best_fraction = fraction;
      }
      if (now <= (1 - 0.1 * fraction) * merit) break;
    }
    short_steps_ = best_fraction < 0.2 ? short_steps_ + 1 : 0;
    full_step_ = best_fraction == 1.0;
    x += best_fraction * step_;
    if (fraction == best_fraction) return best;
    set_multipliers(best_fraction);
    return measure(x);
  }
  /// The part of the merit that depends on the smoothing, anew after reduce().
  double remeasure(const Vector& x) {
    const Stopwatch watch(timings_.assembly);
    measure_mismatch(x);
    return mismatch_.mean_square + gradient_square_;
  }

 private:
  struct Worst {
    double worst = 0, mean_square = 0;
  };
  bool factorize(const Vector& x, Curvature curvature) {
    {
      const Stopwatch watch(timings_.assembly);
      linearise(Linearisation::primal_dual);
      assembly_.hessian(x, curvature, &gradient_);
    }
    const Stopwatch watch(timings_.factorization);
    ++counts_.factorizations;
    const bool positive = cholesky_.factorize(assembly_.matrix());
    if (!positive && curvature == Curvature::exact) exact_wait_ = exact_patience_ *= 2;
    return positive;
  }
  /// The exact matrix converges faster wherever it is positive definite; after a failure it is left alone for a while.
  bool use_exact() { return full_step_ && width_ <= 1e-3 && (exact_wait_ == 0 || --exact_wait_ == 0); }
  void linearise(Linearisation linearisation) {
    for (EliminatedSlack& slack : slacks_) slack.set_linearisation(linearisation);
  }
  void set_width(double width) {
    width_ = width;
    for (EliminatedSlack& slack : slacks_) {
      const double scaled = width * slack.constraint().violation_scale();
      slack.set_epsilon(scaled * scaled);
    }
  }
  void set_multipliers(double fraction) {
    for (std::size_t k = 0; k < slacks_.size(); ++k) {
      slacks_[k].set_multipliers(start_multipliers_[k] + fraction * multiplier_steps_[k]);
    }
  }

  Assembly& assembly_;
  Cholesky& cholesky_;
  std::deque<EliminatedSlack>& slacks_;
  int node_size_;
  double force_scale_;
  const CentralPathOptions& options_;
  Counts& counts_;
  Timings& timings_;
  int short_steps_ = 0;
  bool full_step_ = false;
  int exact_wait_ = 0, exact_patience_ = 1;
  double width_ = 0, force_ = 0, gradient_square_ = 0;
  Worst mismatch_;
  Vector gradient_, right_hand_side_, solution_, step_;
  std::vector<Vector> multiplier_steps_, start_multipliers_;
};

}  // namespace

void CentralPathOptions::validate() const {
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(std::string("CentralPathOptions: ") + what);
  };
  require(penalty_fraction > 0, "penalty_fraction must be positive");
  require(reduction > 0 && reduction < 1, "reduction must be between 0 and 1");
  require(centred > 0, "centred must be positive");
  require(smallest_width > 0, "smallest_width must be positive");
  require(max_iterations >= 1 && max_halvings >= 1, "max_iterations and max_halvings must be at least 1");
}

bool follow_central_path(Assembly& assembly, Cholesky& cholesky, std::deque<EliminatedSlack>& slacks, int node_size,
                         double force_scale, double force_tolerance, const CentralPathOptions& options, Vector& x,
                         const std::function<bool(const Vector&)>& accept, const Budget& budget, Counts& counts,
                         Timings& timings) {
  CentralPath path(assembly, cholesky, slacks, node_size, force_scale, options, counts, timings);
  path.start(x);
  double merit = path.measure(x);
  bool accepted = false;
  for (int iteration = 0; iteration < options.max_iterations && std::isfinite(merit); ++iteration) {
    if (path.width() <= 1e-4 && path.force() <= force_tolerance && accept(x)) {
      accepted = true;
      break;
    }
    if (iteration > 0 && path.centred()) {
      path.reduce();
      merit = path.remeasure(x);
    }
    if (path.lost() || budget.interrupted() || budget.out_of_time() || !path.step(x)) break;
    merit = path.advance(x, merit);
  }
  for (EliminatedSlack& slack : slacks) slack.set_linearisation(Linearisation::augmented_lagrangian);
  return accepted;
}

}  // namespace taut
