#include "study/lean_screening.h"

#include <algorithm>

namespace taut {
namespace {

/// Of the allowed error, what all omissions together may take.
constexpr double share_of_omissions = 0.5;
/// What is left out should save time: a trial with this many times as many linear solves, and some more, is given up.
constexpr double patience = 1.5;
constexpr long some_more = 20;

class Screening {
 public:
  Screening(const LeanLadder& ladder, const Levels& levels, LeanRuns& runs, LeanErrors& errors, LeanOutcome& outcome)
      : ladder_(ladder),
        runs_(runs),
        errors_(errors),
        outcome_(outcome),
        base_(runs.run(levels)),
        bare_(levels),
        chosen_(levels),
        changes_(levels.size(), -1) {}

  Levels go() {
    for (std::size_t k = 0; k < bare_.size(); ++k)
      if (!ladder_.simplifications[k].refines()) try_alone(k);
    accept_together();
    return chosen_;
  }

 private:
  bool is_little(double change) const { return lean_safety * change <= share_of_omissions * runs_.allowed(); }
  void try_alone(std::size_t k);
  void accept_together();

  const LeanLadder& ladder_;
  LeanRuns& runs_;
  LeanErrors& errors_;
  LeanOutcome& outcome_;
  std::size_t base_;  // the model without omissions
  Levels bare_, chosen_;
  std::vector<double> changes_;  // by what is chosen, each alone
};

/// Tries an omission, from its mildest form on, as long as it changes little enough.
void Screening::try_alone(std::size_t k) {
  const Simplification& omission = ladder_.simplifications[k];
  const long most = static_cast<long>(patience * static_cast<double>(runs_[base_].linear_solves)) + some_more;
  for (int level = 1; level <= omission.simplest(); ++level) {
    Levels levels = bare_;
    levels[k] = level;
    const std::size_t trial = runs_.run(levels, most);
    OmissionTrial record{.what = omission.levels[static_cast<std::size_t>(level)],
                         .change = runs_.between(base_, trial),
                         .left_out = false,
                         .why = ""};
    errors_.add_omissions(levels, record.change);
    const bool dearer = 5 * runs_[trial].linear_solves > 6 * runs_[base_].linear_solves;
    if (!runs_[trial].answer)
      record.why = runs_[trial].status + ": " + runs_[trial].message;
    else if (!is_little(record.change))
      record.why = "it changes the answer";
    else if (dearer)
      record.why = "it takes more linear solves";
    record.left_out = record.why.empty();
    if (record.left_out && level > 1) {
      outcome_.omissions.back().left_out = false;
      outcome_.omissions.back().why = "a simpler form serves";
    }
    outcome_.omissions.push_back(record);
    if (!record.left_out) return;
    changes_[k] = record.change;
    chosen_[k] = level;
  }
}

/// What is harmless one by one has to be so together; else what changes most stays.
void Screening::accept_together() {
  while (true) {
    const std::size_t together = runs_.run(chosen_);
    if (together != base_) errors_.add_omissions(chosen_, runs_.between(base_, together));
    if (is_little(errors_.of_omissions(chosen_))) return;
    const auto most = std::max_element(changes_.begin(), changes_.end());
    if (*most < 0) return;
    const auto k = static_cast<std::size_t>(most - changes_.begin());
    for (OmissionTrial& trial : outcome_.omissions) {
      if (trial.left_out && trial.what == ladder_.simplifications[k].levels[static_cast<std::size_t>(chosen_[k])]) {
        trial.left_out = false;
        trial.why = "with the others it changes the answer";
      }
    }
    chosen_[k] = 0;
    *most = -1;
  }
}

}  // namespace

Levels screen_omissions(const LeanLadder& ladder, const Levels& levels, LeanRuns& runs, LeanErrors& errors,
                        LeanOutcome& outcome) {
  return Screening(ladder, levels, runs, errors, outcome).go();
}

}  // namespace taut
