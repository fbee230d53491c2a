#pragma once

#include <string>
#include <vector>

#include "study/stress.h"

namespace taut {

/// The solver whose losses are counted: the one that problems use by default.
inline constexpr const char* default_method = "augmented_lagrangian";

/// A cell that another method solves and the default one does not.
struct StressLoss {
  std::string entry, value, winner;
  StressCell cell;        ///< of the default method
  std::string mechanism;  ///< why, as the atlas says; empty: not explained yet
};
std::vector<StressLoss> losses(const StressAtlas& atlas);

/// The outcomes as a text to store: a letter per value for each entry and method.
std::string frontiers_text(const StressAtlas& atlas);

/// What has become worse than the stored text says, a sentence each: a frontier that moved back, a false success or a
/// crash where there was none; besides, whatever the default method must never have: a false success, a crash, a loss
/// without a mechanism. What is not stored is not compared. Throws InputError for a text that is no such thing or that
/// belongs to other values, `source` being what errors call it.
std::vector<std::string> regressions(const StressAtlas& atlas, const std::string& stored, const std::string& source);

}  // namespace taut
