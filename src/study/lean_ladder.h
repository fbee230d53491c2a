#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "problems/scene.h"

namespace taut {

/// One way to make a scene cheaper, from level 0, as it is written, to the simplest.
struct Simplification {
  enum class Kind {
    refinement,  ///< levels of one discretisation, each half as fine as the one before
    omission     ///< something is left out, or replaced by something simpler
  };
  std::string name;  ///< "mesh", "bending of cloth"
  Kind kind = Kind::refinement;
  std::vector<std::string> levels;  ///< what each level is, in words: "16 x 16 cells"
  double cost_ratio = 1;            ///< seconds of a level over those of the next simpler one, before any is measured
  double solve_ratio = 1;           ///< the same of a single linear solve
  bool has_residual = false;        ///< a residual may tell what one level more changes (residual_estimate.h)
  std::function<void(nlohmann::json& document, int level)> apply;

  bool refines() const { return kind == Kind::refinement; }
  int simplest() const { return static_cast<int>(levels.size()) - 1; }
};

/// A simplification that the scene does not allow.
struct NotApplicable {
  std::string name, reason;
};

/// All that a scene could do without.
struct LeanLadder {
  std::vector<Simplification> simplifications;
  std::vector<NotApplicable> not_applicable;
  double full_linear_solves = 0;  ///< more than most scenes of this many steps take; 0: not known
};

/// A level for each simplification of a ladder: a rung.
using Levels = std::vector<int>;

/// True for the scene as it is written.
bool is_full(const Levels& levels);

/// What can be made coarser or left out so that it may cost less.
LeanLadder lean_ladder(const Scene& scene);

/// What can be left out at all, one thing each: loads, gravity, damping, obstacles and springs too.
LeanLadder omissions_of(const Scene& scene);

/// Writes the problem of a rung. Point loads on a region keep their sum where the mesh changes. Throws InputError for a
/// rung whose problem cannot be read, FileError.
void write_rung(const Scene& scene, const LeanLadder& ladder, const Levels& levels, const std::string& name,
                const std::filesystem::path& file);

/// "8 x 8 cells, without bending of cloth"; "as written" for the full scene.
std::string words_of(const LeanLadder& ladder, const Levels& levels);

}  // namespace taut
