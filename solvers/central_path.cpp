#include "solvers/central_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/stopwatch.h"

namespace taut {
namespace {

using Linearisation = EliminatedSlack::Linearisation;

/// Of the unbalanced forces. Right-hand sides are no measure: multipliers that do not fit yet make them huge.
constexpr double left_by_iterations = 0.05;

/// The iteration's data, so that its parts read as what they are.
class CentralPath {
 public:
  CentralPath(Assembly& assembly, NewtonSystem& system, const EqualityRows& equalities,
              std::deque<EliminatedSlack>& slacks, const std::vector<int>& fixed, int node_size, double force_scale,
              double force_tolerance, const CentralPathOptions& options, int threads, Vector& equal, Counts& counts,
              Timings& timings)
      : assembly_(assembly),
        system_(system),
        equalities_(equalities),
        slacks_(slacks),
        fixed_(fixed),
        node_size_(node_size),
        force_scale_(force_scale),
        force_tolerance_(force_tolerance),
        options_(options),
        threads_(threads),
        counts_(counts),
        timings_(timings),
        equal_(equal),
        multiplier_steps_(slacks.size()),
        start_multipliers_(slacks.size()) {}

  /// Smoothing in proportion to how badly the warm-started multipliers fit.
  void start(const Vector& x) {
    for (EliminatedSlack& slack : slacks_) slack.set_linearisation(Linearisation::central_path);
    {
      const Stopwatch watch(timings_.assembly);
      width_ = 1e-6;
      set_point(x);
      width_ = std::clamp(0.3 * worst_mismatch_, 1e-5, 0.1);
      set_point(x);
    }
    ++counts_.function_evaluations;
    measure_forces(x, true);
  }

  double width() const { return width_; }
  double force() const { return force_; }
  double merit() const { return merit_; }
  /// True after a dozen steps in a row that the merit function cut short, and where half of all steps have not brought
  /// the forces near a balance: the path is lost.
  bool lost() const {
    return short_steps_ >= 12 || (2 * steps_ >= options_.max_iterations && force_ > 0.01 * force_scale_);
  }

  /// Solves for the step in x, multipliers and width; false where the matrix is not positive definite.
  bool step(const Vector& x) {
    ++steps_;
    start_width_ = target_width_ = width_;
    if (centred()) target_width_ = std::max(std::sqrt(options_.reduction) * width_, options_.smallest_width);
    if (!matrix_is_here_) make_matrix(x);
    right_hand_side_ = gradient_;
    {
      const Stopwatch watch(timings_.assembly);
      for (EliminatedSlack& slack : slacks_) {
        const double scaled = target_width_ * slack.constraint().violation_scale();
        slack.aim(scaled * scaled, threads_, right_hand_side_);
      }
    }
    if (!solve()) {
      if (curvature_ != Curvature::exact) return false;
      wait_ = patience_;
      patience_ = std::min(2 * patience_, 64);
      make_matrix(x);
      if (!solve()) return false;
    }
    const Stopwatch watch(timings_.assembly);
    for (std::size_t k = 0; k < slacks_.size(); ++k) {
      slacks_[k].multiplier_step(step_, threads_, multiplier_steps_[k]);
      start_multipliers_[k] = slacks_[k].multipliers();
      if (!multiplier_steps_[k].allFinite()) return false;
    }
    start_equal_ = equal_;
    return step_.allFinite() && equal_step_.allFinite();
  }

  /// Halves the step until the merit does not rise much or the path is near, or takes the best fraction tried. The
  /// first trial is usually taken, so the next matrix is made along with its forces, unless a width of at most
  /// `last_width` makes it likely that there is no next step; where the multipliers' mismatch alone is too large,
  /// neither is. A path that crawls for six steps takes the next one as it is (a watchdog [Chamberlain et al. 1982]):
  /// where many elements are at a kink, every short step is an improvement and none gets anywhere.
  void advance(Vector& x, double last_width) {
    const double before = merit_;
    double fraction =
        std::min(believable_fraction(x, step_, options_.longest_step), 0.9 * assembly_.largest_step(x, step_));
    double best_fraction = fraction, best = std::numeric_limits<double>::infinity();
    const bool unchecked = crawling_ >= 6 && steps_ > options_.exact_after;
    bool accepted = false;
    for (int halving = 0; halving < options_.max_halvings && !accepted; ++halving) {
      if (halving > 0) fraction *= 0.5;
      const double tolerated = options_.tolerated_rise * (1 - 0.1 * fraction) * before;
      move(x, fraction);
      // A shorter width raises the merit of a point that was on the path.
      const bool may_be_near = target_width_ < start_width_ && centred();
      if (unchecked || merit_ <= tolerated || may_be_near) {
        measure_forces(trial_, halving == 0 && width_ > last_width);
        const bool near = may_be_near && force_ <= width_ * force_scale_;
        accepted = merit_ <= tolerated || ((unchecked || near) && std::isfinite(merit_));
      }
      if (merit_ < best || accepted) {
        best = merit_;
        best_fraction = fraction;
      }
    }
    if (!accepted) {
      move(x, best_fraction);
      measure_forces(trial_, false);
    }
    short_steps_ = best_fraction < 0.2 ? short_steps_ + 1 : 0;
    crawling_ = best_fraction < 0.3 ? crawling_ + 1 : 0;
    std::swap(x, trial_);
  }

 private:
  /// False where the matrix is not positive definite.
  bool solve() {
    const double unbalanced = std::max(gradient_.norm(), 0.1 * force_tolerance_);
    system_.allow(curvature_ == Curvature::exact ? 0 : left_by_iterations * unbalanced);
    {
      const Stopwatch watch(timings_.factorization);
      ++counts_.factorizations;
      if (!system_.factorize(0)) return false;
    }
    const Stopwatch watch(timings_.solve);
    ++counts_.linear_solves;
    return system_.solve(right_hand_side_, violation_, step_, equal_step_);
  }

  /// The semidefinite matrix, or late on the path the exact one, where it was not indefinite lately.
  void make_matrix(const Vector& x) {
    const Stopwatch watch(timings_.assembly);
    const bool exact = steps_ >= options_.exact_after && --wait_ < 0;
    curvature_ = exact ? Curvature::exact : Curvature::positive_semidefinite;
    // What bends little beside the inertia may be what it was at the start of the path.
    assembly_.hessian(x, curvature_, &gradient_, !exact && has_weak_values_ && system_.iterates());
    has_weak_values_ = !exact;
    complete_gradient();
    matrix_is_here_ = true;
  }

  /// What the assembly knows nothing of: the forces of the equalities, and which of all forces count.
  void complete_gradient() {
    equalities_.add_force(equal_, gradient_);
    for (int variable : fixed_) gradient_[variable] = 0;
  }

  bool centred() const { return worst_mismatch_ <= options_.centred * width_; }

  /// Positions, multipliers and epsilon at a fraction of the step, and the mismatch there.
  void move(const Vector& x, double fraction) {
    trial_ = x + fraction * step_;
    equal_ = start_equal_ + fraction * equal_step_;
    for (std::size_t k = 0; k < slacks_.size(); ++k) {
      slacks_[k].set_multipliers(start_multipliers_[k] + fraction * multiplier_steps_[k]);
    }
    width_ = std::sqrt((1 - fraction) * start_width_ * start_width_ + fraction * target_width_ * target_width_);
    ++counts_.function_evaluations;
    const Stopwatch watch(timings_.assembly);
    set_point(trial_);
  }

  /// Gradients and sum of w J^T lambda at the point set, into the merit; with the matrix of the Newton step from here
  /// where that is wanted.
  void measure_forces(const Vector& x, bool with_matrix) {
    matrix_is_here_ = false;
    if (with_matrix) {
      make_matrix(x);
    } else {
      const Stopwatch watch(timings_.assembly);
      assembly_.gradient(x, gradient_);
      complete_gradient();
    }
    equalities_.violation(x, violation_);
    if (equalities_.count() > 0) merit_ += violation_.squaredNorm() / x.squaredNorm();
    force_ = nodal_max_norm(gradient_, node_size_);
    merit_ += gradient_.squaredNorm() / (force_scale_ * force_scale_);
  }

  /// How badly the multipliers fit at x, which is the first part of the merit.
  void set_point(const Vector& x) {
    worst_mismatch_ = merit_ = 0;
    for (EliminatedSlack& slack : slacks_) {
      const double scale = slack.constraint().violation_scale(), scaled = width_ * scale;
      const EliminatedSlack::Mismatch one = slack.set_point(x, scaled * scaled, threads_);
      worst_mismatch_ = std::max(worst_mismatch_, one.max / scale);
      merit_ += one.mean_square / (scale * scale);
    }
  }

  Assembly& assembly_;
  NewtonSystem& system_;
  const EqualityRows& equalities_;
  std::deque<EliminatedSlack>& slacks_;
  const std::vector<int>& fixed_;
  int node_size_;
  double force_scale_, force_tolerance_;
  const CentralPathOptions& options_;
  int threads_;
  Counts& counts_;
  Timings& timings_;
  Vector& equal_;
  Vector equal_step_, start_equal_, violation_;
  int short_steps_ = 0, crawling_ = 0;
  double width_ = 0, start_width_ = 0, target_width_ = 0;
  double force_ = 0, worst_mismatch_ = 0, merit_ = 0;
  bool matrix_is_here_ = false;
  bool has_weak_values_ = false;  // the assembly holds semidefinite ones of this path
  Curvature curvature_ = Curvature::positive_semidefinite;
  int steps_ = 0, wait_ = 0, patience_ = 1;
  Vector gradient_, right_hand_side_, step_, trial_;
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
  require(tolerated_rise >= 1, "tolerated_rise must be at least 1");
  require(smallest_width > 0, "smallest_width must be positive");
  require(exact_after >= 0, "exact_after must not be negative");
  require(max_iterations >= 1 && max_halvings >= 1, "max_iterations and max_halvings must be at least 1");
}

bool follow_central_path(Assembly& assembly, NewtonSystem& system, const EqualityRows& equalities,
                         std::deque<EliminatedSlack>& slacks, const std::vector<int>& fixed, int node_size,
                         double force_scale, const Tolerances& tolerances, const CentralPathOptions& options,
                         int threads, Vector& x, Vector& equal, const std::function<double(const Vector&)>& judge,
                         const std::function<void(const Vector&)>& observe, const Budget& budget, Counts& counts,
                         Timings& timings) {
  const double force_tolerance = tolerances.stationarity * force_scale;
  CentralPath path(assembly, system, equalities, slacks, fixed, node_size, force_scale, force_tolerance, options,
                   threads, equal, counts, timings);
  path.start(x);
  bool accepted = false;
  // The residuals are about as small as the width, and shrink as it does.
  double ask_below =
      std::max(10 * std::min({tolerances.stationarity, tolerances.feasibility, tolerances.complementarity}),
               10 * options.smallest_width);
  for (int iteration = 0; iteration < options.max_iterations && std::isfinite(path.merit()); ++iteration) {
    if (observe) observe(x);
    if (path.width() <= ask_below && path.force() <= force_tolerance) {
      const double ratio = judge(x);
      accepted = ratio <= 1;
      if (accepted) break;
      ask_below = path.width() * std::clamp(2 / ratio, 0.1, 1.0);
    }
    if (path.lost() || budget.interrupted() || budget.out_of_time() || !path.step(x)) break;
    path.advance(x, ask_below);
  }
  for (EliminatedSlack& slack : slacks) slack.set_linearisation(Linearisation::augmented_lagrangian);
  system.allow(0);
  return accepted;
}

}  // namespace taut
