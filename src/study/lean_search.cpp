#include "study/lean_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/lean_errors.h"
#include "study/lean_runs.h"
#include "study/lean_screening.h"

namespace taut {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

class Search {
 public:
  Search(const LeanLadder& ladder, const AnswerTolerance& tolerance, const LeanRunner& runner)
      : ladder_(ladder),
        runner_(runner),
        runs_(ladder, tolerance, runner, outcome_),
        errors_(ladder),
        levels_(ladder.simplifications.size()) {
    for (const Simplification& one : ladder.simplifications) by_residual_.push_back(one.has_residual);
  }

  LeanOutcome go();

 private:
  bool refines(std::size_t k) const { return ladder_.simplifications[k].refines(); }
  const LeanCosts& costs() const { return runs_.costs(); }
  Levels above(const Levels& levels) const;
  Levels with(std::size_t k, int level) const;
  bool is_futile();
  void find_start();
  void measure(std::size_t k);
  std::optional<std::size_t> next_refinement();
  bool refine();
  void correct_residuals(double difference);
  bool verify();
  bool is_cheaper(const LeanRung& a, const LeanRung& b) const;
  void end_with_full();
  void end_early();
  void summarise();

  const LeanLadder& ladder_;
  const LeanRunner& runner_;
  LeanOutcome outcome_;
  LeanRuns runs_;
  LeanErrors errors_;
  std::vector<bool> by_residual_;  // whether residuals tell what a refinement changes, until one does not
  Levels levels_;                  // where the search is
};

Levels Search::above(const Levels& levels) const {
  Levels finer = levels;
  for (std::size_t k = 0; k < finer.size(); ++k) finer[k] = refines(k) ? std::max(0, finer[k] - 1) : 0;
  return finer;
}

Levels Search::with(std::size_t k, int level) const {
  Levels changed = levels_;
  changed[k] = level;
  return changed;
}

/// True where even the finest models that are cheaper than the full scene, each with one refinement alone made
/// coarser, are expected to be too wrong.
bool Search::is_futile() {
  double smallest = infinity;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    if (!refines(k)) continue;
    const int level = costs().worthwhile_level(k);
    if (level > ladder_.simplifications[k].simplest()) continue;
    smallest = std::min(smallest, errors_.least_estimate(k, level));
  }
  return smallest > runs_.allowed();
}

/// Where every refinement is at its simplest, or at the first level that is solved.
void Search::find_start() {
  for (std::size_t k = 0; k < levels_.size(); ++k) levels_[k] = refines(k) ? ladder_.simplifications[k].simplest() : 0;
  while (!runs_[runs_.run(levels_)].answer && !is_full(levels_)) levels_ = above(levels_);
}

/// What one level more of a refinement changes: by a residual, else by running it. Where it is cheaper, as shorter
/// steps can be, the search goes there.
void Search::measure(std::size_t k) {
  const std::size_t coarse = runs_.run(levels_);
  const Levels finer = with(k, levels_[k] - 1);
  if (by_residual_[k] && !runs_.was_run(finer)) {
    const std::optional<double> change = runs_.change_by_residual(coarse, finer);
    by_residual_[k] = change.has_value();
    if (change) return errors_.add_difference(k, levels_[k], *change);
  }
  const std::size_t fine = runs_.run(finer);
  errors_.add_difference(k, levels_[k], runs_.between(coarse, fine));
  const bool cheaper = runs_[fine].work > 0 && runs_[fine].work < runs_[coarse].work;
  if (runs_[fine].answer && cheaper) --levels_[k];
}

/// The refinement to improve next: of those whose error alone is too large, which have to be refined in any case, the
/// one that costs least; else that with the largest error.
std::optional<std::size_t> Search::next_refinement() {
  std::optional<std::size_t> cheapest, worst;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    if (!refines(k) || levels_[k] == 0) continue;
    const double error = errors_.of_refinement(k, levels_[k]);
    if (!worst || error > errors_.of_refinement(*worst, levels_[*worst])) worst = k;
    const bool too_large = lean_safety * errors_.pessimism() * error > runs_.allowed();
    if (too_large && (!cheapest || costs().ratio(k) < costs().ratio(*cheapest))) cheapest = k;
  }
  return cheapest ? cheapest : worst;
}

/// Makes a refinement finer, or puts back what was left out where that is more wrong. False where nothing is left to do
/// that would be cheaper than the full scene.
bool Search::refine() {
  const std::optional<std::size_t> next = next_refinement();
  const double left_out = errors_.of_omissions(levels_);
  if (left_out > 0 && (!next || left_out > errors_.of_refinement(*next, levels_[*next]))) {
    for (std::size_t k = 0; k < levels_.size(); ++k)
      if (!refines(k)) levels_[k] = 0;
    return true;
  }
  if (!next) return false;
  if (errors_.knows(*next, levels_[*next]))
    --levels_[*next];
  else if (costs().is_worth_running(with(*next, levels_[*next] - 1)))
    measure(*next);
  else
    return false;
  return true;
}

/// A run knows better than a residual: what the model above differs by, beyond all that is known of the refinements,
/// goes to the largest difference that a residual has told.
void Search::correct_residuals(double difference) {
  std::optional<std::size_t> largest;
  double missing = difference;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    if (!refines(k)) continue;
    const double known = errors_.difference(k, levels_[k]);
    missing -= known;
    if (!by_residual_[k] || !errors_.knows(k, levels_[k])) continue;
    if (!largest || known > errors_.difference(*largest, levels_[*largest])) largest = k;
  }
  if (largest && missing > 0)
    errors_.add_difference(*largest, levels_[*largest], errors_.difference(*largest, levels_[*largest]) + missing);
}

/// Compares the model with the one above. True where the search ends.
bool Search::verify() {
  const Levels finer = above(levels_);
  if (is_full(finer) || !costs().is_worth_running(finer)) {
    if (costs().is_worth_running(levels_)) runs_.run(levels_);
    end_with_full();
    return true;
  }
  const std::size_t lean = runs_.run(levels_), reference = runs_.run(finer);
  const double difference = runs_.between(lean, reference);
  correct_residuals(difference);
  const double expected = errors_.estimate(levels_) - errors_.estimate(finer);
  runs_[lean].verified = difference + errors_.estimate(finer);
  if (*runs_[lean].verified <= runs_.allowed()) {
    outcome_.end = LeanEnd::verified;
    outcome_.lean = lean;
    outcome_.above = reference;
    return true;
  }
  errors_.compare(expected, difference);
  levels_ = finer;
  return false;
}

/// By what refinements should save, then by work.
bool Search::is_cheaper(const LeanRung& a, const LeanRung& b) const {
  const double first = costs().saving(a.levels), second = costs().saving(b.levels);
  return first != second ? first > second : a.work < b.work;
}

/// Everything is compared with the full scene, and the cheapest of what is right is taken.
void Search::end_with_full() {
  const std::size_t full = runs_.run(Levels(levels_.size(), 0));
  outcome_.full = full;
  if (!runs_[full].answer) return;
  outcome_.end = LeanEnd::exact;
  outcome_.above = full;
  for (std::size_t k = 0; k < outcome_.rungs.size(); ++k) {
    if (!runs_[k].answer) continue;
    runs_[k].verified = runs_.between(k, full);
    if (*runs_[k].verified > runs_.allowed()) continue;
    if (!outcome_.lean || is_cheaper(runs_[k], runs_[*outcome_.lean])) outcome_.lean = k;
  }
}

/// The model with the smallest estimate.
void Search::end_early() {
  outcome_.end = runner_.interrupted() ? LeanEnd::interrupted : LeanEnd::over_budget;
  double smallest = infinity;
  for (std::size_t k = 0; k < outcome_.rungs.size(); ++k) {
    if (!runs_[k].answer) continue;
    const double error = errors_.estimate(runs_[k].levels);
    if (outcome_.lean && error >= smallest) continue;
    smallest = error;
    outcome_.lean = k;
  }
}

void Search::summarise() {
  runs_.allowed();
  const LeanRung* costliest = nullptr;
  for (LeanRung& rung : outcome_.rungs) {
    if (!rung.answer) continue;
    const double error = errors_.estimate(rung.levels);
    if (std::isfinite(error)) rung.estimated = error;
    if (!costliest || rung.seconds > costliest->seconds) costliest = &rung;
  }
  if (outcome_.full)
    outcome_.predicted_full_seconds = runs_[*outcome_.full].seconds;
  else if (costliest)
    outcome_.predicted_full_seconds = costs().full_seconds(*costliest);
}

LeanOutcome Search::go() {
  try {
    find_start();
    if (is_full(levels_)) {
      end_with_full();
    } else {
      for (std::size_t k = levels_.size(); k-- > 0;)  // the mesh, which costs most, last
        if (refines(k) && levels_[k] > 0) measure(k);
      levels_ = screen_omissions(ladder_, levels_, runs_, errors_, outcome_);
      bool done = false;
      while (!done) {
        if (lean_safety * errors_.estimate(levels_) <= runs_.allowed()) {
          done = verify();
        } else if (is_futile() || !refine()) {
          end_with_full();
          done = true;
        }
      }
    }
  } catch (const LeanHalt&) {
    end_early();
  }
  summarise();
  return std::move(outcome_);
}

}  // namespace

LeanOutcome lean_search(const LeanLadder& ladder, const AnswerTolerance& tolerance, const LeanRunner& runner) {
  return Search(ladder, tolerance, runner).go();
}

}  // namespace taut
