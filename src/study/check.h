#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/residuals.h"
#include "core/result.h"
#include "problems/scene.h"
#include "study/probes.h"
#include "study/verdicts.h"

namespace taut {

/// The verdicts on one frame.
struct FrameVerdict {
  std::string file;
  int number = 0;   ///< for runs of taut the step
  double time = 0;  ///< s (static: load fraction)
  std::vector<Verdict> verdicts;

  bool within() const;
};

/// A step of a stored run, posed and judged once more.
struct RecomputedStep {
  int step = 0;
  Status claimed = Status::solved;  ///< in steps.jsonl
  Residuals residuals;
  /// Directions of negative curvature (solvers/curvature.h); of problems with linear equalities only.
  std::optional<Index> negative_curvatures{};
};

enum class CheckVerdict { within, outside, unusable };
std::string_view to_string(CheckVerdict verdict);

/// What a check has found. Each line of `unusable` and `findings` is a sentence that names the file or the element.
struct CheckReport {
  std::string problem, subject;      ///< subject: the folder of the run, or the first pattern
  double tolerance = 0;              ///< of violations, relative
  std::vector<FrameVerdict> frames;  ///< those that could be judged
  std::vector<Verdict> worst;        ///< of each constraint over all frames, `elements` and `violated` summed up
  std::optional<RecomputedStep> last_step;
  std::vector<ProbeValue> probes;     ///< of a run, computed from its last state
  int steps_done = 0;                 ///< of a run
  std::vector<std::string> unusable;  ///< what kept files from being judged
  std::vector<std::string> findings;  ///< what is not within tolerance, and claims that are not true

  CheckVerdict verdict() const;
};

/// Judges a run in the folder that `taut solve --out` has written by its problem.json and the stored result alone.
///
/// The last step is posed anew from the state before it and its residuals are computed with the stored positions and
/// multipliers. From every stored frame come violations and energies. All are compared with what steps.jsonl says of
/// the step, and summary.json with the steps. A difference beyond round-off is a finding. `tolerance` replaces the
/// problem's solver.tolerance.feasibility. Frames before the first step are compared with the problem, not judged.
///
/// Throws InputError, RunRefused or FileError where there is no run that can be read.
CheckReport check_run(const std::filesystem::path& folder, std::optional<double> tolerance);

/// Frames that any simulator wrote, and when they are.
struct FrameOptions {
  std::vector<std::string> patterns;
  /// With neither, frame number k is step k of the problem. With either, the first frame is at first_time (0) and later
  /// ones follow by `step` (the problem's) for every number, s (static: load fraction).
  std::optional<double> step, first_time;
  std::optional<double> tolerance;  ///< relative; the problem's solver.tolerance.feasibility where not given
  double largest_fold = 150;        ///< degrees, beyond which a face counts as inverted (PositionJudge::faces)
};

/// Judges positions by the constraints of a scene and for bad faces (PositionJudge). Vertices must be in the scene's
/// order: bodies one after another in order of name. Throws InputError for a scene that cannot be built.
CheckReport check_frames(const Scene& scene, const FrameOptions& options);

/// Fills `worst` from the frames and adds a finding for each constraint that a frame violates. `first_judged`: frames
/// with a smaller number are passed over.
void take_worst(CheckReport& report, int first_judged);

}  // namespace taut
