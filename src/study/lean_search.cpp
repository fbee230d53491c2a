#include "study/lean_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace taut {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
/// Of the allowed error, what all omissions together may take.
constexpr double share_of_omissions = 0.5;
/// A rung that is not this much cheaper than the full scene is not worth running: the full scene is.
constexpr double least_saving = 2;
/// What is left out should save time: a trial that takes this many times as long, and a second, is given up.
constexpr double patience = 1.5;
/// No further model may be started.
struct Halt {};

bool is_full(const Levels& levels) {
  return std::all_of(levels.begin(), levels.end(), [](int level) { return level == 0; });
}

class Search {
 public:
  Search(const LeanLadder& ladder, const AnswerTolerance& tolerance, const LeanRunner& runner)
      : ladder_(ladder),
        tolerance_(tolerance),
        runner_(runner),
        convergence_(ladder.simplifications.size()),
        cost_ratio_(ladder.simplifications.size()),
        levels_(ladder.simplifications.size()) {
    for (std::size_t k = 0; k < levels_.size(); ++k) cost_ratio_[k] = ladder.simplifications[k].cost_ratio;
  }

  LeanOutcome go();

 private:
  bool refines(std::size_t k) const { return ladder_.simplifications[k].kind == Simplification::Kind::refinement; }
  std::size_t run(const Levels& levels, double max_seconds = 0);
  LeanRung& rung(std::size_t index) { return outcome_.rungs[index]; }
  double between(std::size_t a, std::size_t b);
  double allowed();
  Levels above(const Levels& levels) const;
  Levels with(std::size_t k, int level) const;
  double estimate(const Levels& levels) const;
  Levels omissions_in(const Levels& levels) const;
  double omitted(const Levels& levels) const;
  int coarseness(const Levels& levels) const;
  double saving(const Levels& levels) const;
  void learn_costs(const LeanRung& now);
  bool is_futile();
  void find_start();
  void measure(std::size_t k);
  void screen();
  void screen_one(std::size_t k, std::size_t base, std::vector<double>& changes);
  void accept_together(std::size_t base, std::vector<double>& changes);
  std::optional<std::size_t> next_refinement();
  bool refine();
  bool verify();
  bool is_cheaper(const LeanRung& a, const LeanRung& b) const;
  void end_with_full();
  void end_early();
  void summarise();

  const LeanLadder& ladder_;
  const AnswerTolerance& tolerance_;
  const LeanRunner& runner_;
  std::vector<Convergence> convergence_;  // of each simplification that refines
  std::vector<double> cost_ratio_;
  Levels levels_;                     // where the search is
  std::map<Levels, double> changes_;  // of the answer, by what is left out
  double pessimism_ = 1;              // how far measured differences have exceeded estimates
  LeanOutcome outcome_;
};

/// The place of a model among those that were run, where it is put if it was not.
std::size_t Search::run(const Levels& levels, double max_seconds) {
  for (std::size_t k = 0; k < outcome_.rungs.size(); ++k)
    if (outcome_.rungs[k].levels == levels) return k;
  if (runner_.interrupted() || runner_.out_of_time()) throw Halt{};
  LeanRung done = runner_.run(levels, max_seconds);
  if (done.status != "solved" && (runner_.interrupted() || runner_.out_of_time())) throw Halt{};
  done.levels = levels;
  learn_costs(done);
  outcome_.rungs.push_back(std::move(done));
  return outcome_.rungs.size() - 1;
}

double Search::between(std::size_t a, std::size_t b) {
  const std::optional<Answer>&first = rung(a).answer, &second = rung(b).answer;
  return first && second ? distance(*first, *second) : infinity;
}

/// The sum of the levels of all refinements.
int Search::coarseness(const Levels& levels) const {
  int sum = 0;
  for (std::size_t k = 0; k < levels.size(); ++k)
    if (refines(k)) sum += levels[k];
  return sum;
}

/// By the magnitude of the finest answer so far.
double Search::allowed() {
  const LeanRung* finest = nullptr;
  for (const LeanRung& one : outcome_.rungs)
    if (one.answer && (!finest || coarseness(one.levels) < coarseness(finest->levels))) finest = &one;
  outcome_.magnitude = finest ? finest->answer->magnitude : 0;
  outcome_.allowed = tolerance_.allowed(outcome_.magnitude);
  return outcome_.allowed;
}

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

double Search::estimate(const Levels& levels) const {
  double sum = omitted(levels);
  for (std::size_t k = 0; k < levels.size(); ++k)
    if (refines(k)) sum += convergence_[k].error(levels[k]);
  return pessimism_ * sum;
}

/// What a model leaves out, without its refinements.
Levels Search::omissions_in(const Levels& levels) const {
  Levels part = levels;
  for (std::size_t k = 0; k < part.size(); ++k)
    if (refines(k)) part[k] = 0;
  return part;
}

/// Change of the answer by what a model leaves out, where it was screened.
double Search::omitted(const Levels& levels) const {
  const Levels part = omissions_in(levels);
  if (is_full(part)) return 0;
  const auto found = changes_.find(part);
  return found == changes_.end() ? infinity : found->second;
}

/// How many times cheaper than the full scene a model should be, omissions aside.
double Search::saving(const Levels& levels) const {
  double product = 1;
  for (std::size_t k = 0; k < levels.size(); ++k)
    if (refines(k)) product *= std::pow(cost_ratio_[k], levels[k]);
  return product;
}

/// From the last model before that is coarser or as fine in every refinement: what one level costs. In work, not in
/// seconds, so that the search goes the same way on a busy machine.
void Search::learn_costs(const LeanRung& now) {
  if (!now.answer || now.work == 0) return;
  for (std::size_t last = outcome_.rungs.size(); last-- > 0;) {
    const LeanRung& before = outcome_.rungs[last];
    int levels = 0;
    bool coarser = before.answer && before.work > 0;
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      if (!refines(k)) continue;
      coarser = coarser && before.levels[k] >= now.levels[k];
      levels += before.levels[k] - now.levels[k];
    }
    if (!coarser || levels == 0) continue;
    const double expected = saving(before.levels) / saving(now.levels),
                 correction = std::pow(now.work / before.work / expected, 1.0 / levels);
    for (std::size_t k = 0; k < levels_.size(); ++k)
      if (refines(k) && before.levels[k] > now.levels[k]) cost_ratio_[k] = std::max(1.0, correction * cost_ratio_[k]);
    return;
  }
}

/// True where even the finest models that are cheaper than the full scene, each with one refinement alone made
/// coarser, are expected to be too wrong.
bool Search::is_futile() {
  double smallest = infinity;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    if (!refines(k) || cost_ratio_[k] <= 1) continue;
    const int level = static_cast<int>(std::ceil(std::log(least_saving) / std::log(cost_ratio_[k]) - 1e-9));
    if (level > ladder_.simplifications[k].simplest()) continue;
    smallest = std::min(smallest, pessimism_ * convergence_[k].least_error(level));
  }
  return smallest > allowed();
}

/// Where every refinement is at its simplest, or at the first level that is solved.
void Search::find_start() {
  for (std::size_t k = 0; k < levels_.size(); ++k) levels_[k] = refines(k) ? ladder_.simplifications[k].simplest() : 0;
  while (!rung(run(levels_)).answer && !is_full(levels_)) levels_ = above(levels_);
}

/// What one level more of a refinement changes. Where it is cheaper, as shorter steps can be, the search goes there.
void Search::measure(std::size_t k) {
  const std::size_t coarse = run(levels_), fine = run(with(k, levels_[k] - 1));
  convergence_[k].add(levels_[k], between(coarse, fine));
  const bool cheaper = rung(fine).work > 0 && rung(fine).work < rung(coarse).work;
  if (rung(fine).answer && cheaper) --levels_[k];
}

/// Tries an omission, from its simplest form on, and keeps the first that changes little enough.
void Search::screen_one(std::size_t k, std::size_t base, std::vector<double>& changes) {
  const Simplification& omission = ladder_.simplifications[k];
  for (int level = omission.simplest(); level > 0; --level) {
    const std::size_t trial = run(with(k, level), patience * rung(base).seconds + 1);
    OmissionTrial record{.what = omission.levels[static_cast<std::size_t>(level)],
                         .change = between(base, trial),
                         .left_out = false,
                         .why = ""};
    changes_[omissions_in(rung(trial).levels)] = record.change;
    const bool little = lean_safety * record.change <= share_of_omissions * allowed();
    const bool dearer = 5 * rung(trial).linear_solves > 6 * rung(base).linear_solves;
    if (!rung(trial).answer)
      record.why = rung(trial).status + ": " + rung(trial).message;
    else if (!little)
      record.why = "it changes the answer";
    else if (dearer)
      record.why = "it takes more linear solves";
    record.left_out = record.why.empty();
    outcome_.omissions.push_back(record);
    if (!record.left_out) continue;
    changes[k] = record.change;
    levels_[k] = level;
    return;
  }
}

/// What is harmless one by one has to be so together; else what changes most stays.
void Search::accept_together(std::size_t base, std::vector<double>& changes) {
  while (true) {
    const std::size_t together = run(levels_);
    if (together != base) changes_[omissions_in(levels_)] = between(base, together);
    if (lean_safety * omitted(levels_) <= share_of_omissions * allowed()) return;
    const auto most = std::max_element(changes.begin(), changes.end());
    if (*most < 0) return;
    const auto k = static_cast<std::size_t>(most - changes.begin());
    for (OmissionTrial& trial : outcome_.omissions) {
      if (trial.left_out && trial.what == ladder_.simplifications[k].levels[static_cast<std::size_t>(levels_[k])]) {
        trial.left_out = false;
        trial.why = "with the others it changes the answer";
      }
    }
    levels_[k] = 0;
    *most = -1;
  }
}

void Search::screen() {
  const std::size_t base = run(levels_);
  std::vector<double> changes(levels_.size(), -1);
  Levels chosen = levels_;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    if (refines(k)) continue;
    screen_one(k, base, changes);
    std::swap(chosen[k], levels_[k]);  // each alone
  }
  levels_ = chosen;
  accept_together(base, changes);
}

/// The refinement to improve next: of those whose error alone is too large, which have to be refined in any case, the
/// one that costs least; else that with the largest error.
std::optional<std::size_t> Search::next_refinement() {
  std::optional<std::size_t> cheapest, worst;
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    if (!refines(k) || levels_[k] == 0) continue;
    const double error = convergence_[k].error(levels_[k]);
    if (!worst || error > convergence_[*worst].error(levels_[*worst])) worst = k;
    const bool too_large = lean_safety * pessimism_ * error > allowed();
    if (too_large && (!cheapest || cost_ratio_[k] < cost_ratio_[*cheapest])) cheapest = k;
  }
  return cheapest ? cheapest : worst;
}

/// Makes a refinement finer, or puts back what was left out where that is more wrong. False where nothing is left to do
/// that would be cheaper than the full scene.
bool Search::refine() {
  const std::optional<std::size_t> next = next_refinement();
  const double left_out = omitted(levels_);
  if (left_out > 0 && (!next || left_out > convergence_[*next].error(levels_[*next]))) {
    for (std::size_t k = 0; k < levels_.size(); ++k)
      if (!refines(k)) levels_[k] = 0;
    return true;
  }
  if (!next) return false;
  if (convergence_[*next].knows(levels_[*next]))
    --levels_[*next];
  else if (saving(with(*next, levels_[*next] - 1)) >= least_saving)
    measure(*next);
  else
    return false;
  return true;
}

/// Compares the model with the one above. True where the search ends.
bool Search::verify() {
  const Levels finer = above(levels_);
  if (is_full(finer) || saving(finer) < least_saving) {
    if (saving(levels_) >= least_saving) run(levels_);
    end_with_full();
    return true;
  }
  const std::size_t lean = run(levels_), reference = run(finer);
  const double difference = between(lean, reference), expected = estimate(levels_) - estimate(finer);
  rung(lean).verified = difference + estimate(finer);
  if (*rung(lean).verified <= allowed()) {
    outcome_.end = LeanEnd::verified;
    outcome_.lean = lean;
    outcome_.above = reference;
    return true;
  }
  if (std::isfinite(difference) && expected > 0) pessimism_ *= std::max(1.0, difference / expected);
  levels_ = finer;
  return false;
}

/// By what refinements should save, then by work.
bool Search::is_cheaper(const LeanRung& a, const LeanRung& b) const {
  const double first = saving(a.levels), second = saving(b.levels);
  return first != second ? first > second : a.work < b.work;
}

/// Everything is compared with the full scene, and the cheapest of what is right is taken.
void Search::end_with_full() {
  const std::size_t full = run(Levels(levels_.size(), 0));
  outcome_.full = full;
  if (!rung(full).answer) return;
  outcome_.end = LeanEnd::exact;
  outcome_.above = full;
  for (std::size_t k = 0; k < outcome_.rungs.size(); ++k) {
    if (!rung(k).answer) continue;
    rung(k).verified = between(k, full);
    if (*rung(k).verified > allowed()) continue;
    if (!outcome_.lean || is_cheaper(rung(k), rung(*outcome_.lean))) outcome_.lean = k;
  }
}

/// The model with the smallest estimate.
void Search::end_early() {
  outcome_.end = runner_.interrupted() ? LeanEnd::interrupted : LeanEnd::over_budget;
  double smallest = infinity;
  for (std::size_t k = 0; k < outcome_.rungs.size(); ++k) {
    if (!rung(k).answer) continue;
    const double error = estimate(rung(k).levels);
    if (outcome_.lean && error >= smallest) continue;
    smallest = error;
    outcome_.lean = k;
  }
}

void Search::summarise() {
  allowed();
  std::optional<std::size_t> costliest;
  for (std::size_t k = 0; k < outcome_.rungs.size(); ++k) {
    if (!rung(k).answer) continue;
    const double error = estimate(rung(k).levels);
    if (std::isfinite(error)) rung(k).estimated = error;
    if (!costliest || rung(k).seconds > rung(*costliest).seconds) costliest = k;
  }
  if (costliest) {
    outcome_.predicted_full_seconds = rung(*costliest).seconds;
    for (std::size_t k = 0; k < levels_.size(); ++k)
      if (refines(k))
        outcome_.predicted_full_seconds *= std::pow(ladder_.simplifications[k].cost_ratio, rung(*costliest).levels[k]);
  }
  if (outcome_.full) outcome_.predicted_full_seconds = rung(*outcome_.full).seconds;
}

LeanOutcome Search::go() {
  try {
    find_start();
    if (is_full(levels_)) {
      end_with_full();
    } else {
      for (std::size_t k = levels_.size(); k-- > 0;)  // the mesh, which costs most, last
        if (refines(k) && levels_[k] > 0) measure(k);
      screen();
      bool done = false;
      while (!done) {
        if (lean_safety * estimate(levels_) <= allowed()) {
          done = verify();
        } else if (is_futile() || !refine()) {
          end_with_full();
          done = true;
        }
      }
    }
  } catch (const Halt&) {
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
